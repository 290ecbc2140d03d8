// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8e: evens out the sub-pixel error of neighbouring disparities without crossing edges: a separable bilateral
/// mean, first along the rows, then along the columns. A neighbour at colour distance |dI|
/// and disparity difference e weighs max(0, 1 - (e / max_difference_px)^2) / (1 + (|dI| / gamma)^2).
struct DisparitySmoothingParams {
  int radius = 4;                  ///< px; 0 = off
  double gamma = 15.0;             ///< grey levels
  double max_difference_px = 1.5;  ///< neighbours that differ by more do not count
};

/// In place; NaN pixels stay NaN and do not count. left: CV_8UC1 or CV_8UC3 of the same size.
void smoothDisparity(cv::Mat& disparity, const cv::Mat& left, const DisparitySmoothingParams& params);

}  // namespace fdp_stereo
