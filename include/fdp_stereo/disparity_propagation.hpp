// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

enum class PropagationForm { kWindow, kSurface };

/// Stage 6: feature disparity propagation (paper 3.3, algorithm 1, eq. 11).
struct DisparityPropagationParams {
  bool enabled = true;
  PropagationForm form = PropagationForm::kWindow;
  int window = 5;        ///< W_p is window x window px, odd
  double gamma = 10.0;   ///< eq. (11)
};

/// Lowers costs near the seeds; returns the share (0..1) of the pixels whose costs it may have changed.
///
/// The window form rounds each seed to the nearest pixel and disparity and takes the seeds in raster order. Raw costs
/// are integers: raw <- (raw * f + 2^15) >> 16 with f = round(2^16 (1 - w(p, q))), so that the seed's own becomes 0.
/// Seeds outside the image or the range are passed over.
/// left: the left image, 8-bit, 1 or 3 channels, of the volume's size. Throws std::invalid_argument for another image,
/// an even window or gamma <= 0.
double propagateDisparity(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                          CostVolume& volume);

}  // namespace fdp_stereo
