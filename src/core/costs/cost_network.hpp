// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "costs/cost_network_weights.hpp"

namespace fdp_stereo {

/// The network of matching_cost.type learned: three convolutions that give each pixel a descriptor of what is around
/// it. All in integers: the same bits on every processor.
class CostNetwork {
 public:
  /// Throws std::invalid_argument for weights that are too few or too many, or with which sums could leave 32 bits.
  explicit CostNetwork(const NetworkWeights& weights);

  /// The network built into the library.
  static const CostNetwork& builtIn();

  int length() const { return layers_.back().outputs; }  ///< of a descriptor
  /// Descriptors of a CV_8UC1 image: CV_8SC1, length() numbers per pixel, scaled to a length of at most about kUnit.
  void describe(const cv::Mat& grey, cv::Mat& descriptors) const;

  static constexpr int kUnit = 127;
  static constexpr int kReach = 4;  ///< px around a pixel that its descriptor sees

  struct Layer {
    int side, inputs, outputs;
    int shift;                          ///< from the sums to 1/4096
    std::vector<std::int16_t> weights;  ///< as NetworkKernels::convolve reads them
    std::vector<std::int32_t> biases;
  };

 private:
  std::vector<Layer> layers_;
  double floor2_;  ///< square of the least length, of numbers in 1/4096
};

}  // namespace fdp_stereo
