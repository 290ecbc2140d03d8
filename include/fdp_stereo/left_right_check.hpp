// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8a: left pixels must be the answer of the right pixels that they point at. One pixel alone is a toss of a coin
/// where the texture is weak, so that the pixels around vote.
struct LeftRightCheckParams {
  bool enabled = true;
  double max_difference_px = 1.0;
  bool vote = true;  ///< false: each pixel by itself
};

/// A pixel agrees if one of the two right pixels beside its match differs by up to max_difference_px. It stays if
/// enough of the 7 x 7 px around agree and are reached along a column and then a row of like disparities; without a
/// vote, if it agrees itself. What does not stay, or points beside the right image, becomes NaN.
void checkLeftRight(cv::Mat& disparity_left, const cv::Mat& disparity_right, const LeftRightCheckParams& params);

}  // namespace fdp_stereo
