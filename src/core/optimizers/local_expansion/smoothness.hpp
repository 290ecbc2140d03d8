// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "optimizers/local_expansion/labels.hpp"
#include "simd/local_expansion_kernels.hpp"

namespace fdp_stereo::local_expansion {

struct SmoothnessParams {
  double lambda = 0.5;
  double tau_px = 1.0;
  double gamma = 10.0 / 3.0;
  double epsilon = 0.01;
};

/// The smoothness term: lambda * sum over 8-neighbour pairs of w_pq * min(psi_pq, tau), where
/// psi_pq = |d_p(f_p) - d_p(f_q)| + |d_q(f_p) - d_q(f_q)| and w_pq = max(epsilon, exp(-|I_p - I_q| / gamma)).
class Smoothness {
 public:
  /// image: CV_8UC1 or CV_8UC3.
  Smoothness(const cv::Mat& image, const SmoothnessParams& params);

  /// lambda * w_pq of pixel (x, y) and its neighbour E, SE, S or SW (direction 0..3); 0 where it leaves the image.
  float weight(int direction, int x, int y) const {
    return weights_[direction][static_cast<std::size_t>(y) * size_.width + x];
  }
  /// The weights of one direction, row by row.
  const float* weights(int direction) const { return weights_[direction].data(); }
  float tau() const { return tau_; }
  /// The smoothness term of a whole labelling, in double.
  double energy(const Labels& labels) const;

 private:
  cv::Size size_;
  float tau_;
  std::array<std::vector<float>, kPairDirections> weights_;
};

/// The model's energy of a labelling: the sum of its data terms and its smoothness term.
double energyOf(const Labels& labels, const Smoothness& smoothness);

}  // namespace fdp_stereo::local_expansion
