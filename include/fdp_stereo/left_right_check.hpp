// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8a: a left pixel must be the answer of the right pixel that it points at.
struct LeftRightCheckParams {
  bool enabled = true;
  double max_difference_px = 1.0;
};

/// Sets left pixels that fail, or whose match is outside the right image, to NaN.
void checkLeftRight(cv::Mat& disparity_left, const cv::Mat& disparity_right, const LeftRightCheckParams& params);

}  // namespace fdp_stereo
