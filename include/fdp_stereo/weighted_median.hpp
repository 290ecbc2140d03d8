// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8d: median of the disparities around a pixel, weighted by colour similarity.
struct WeightedMedianParams {
  int radius = 3;             ///< px; 0 = off
  double gamma = 15.0;        ///< grey levels: weight exp(-|dI| / gamma), as eq. (11); 0 = plain median
  double min_range_px = 1.0;  ///< only where the disparities of the 3 x 3 px around differ by more; 0 = everywhere
};

/// In place: the smallest disparity at which the weights reach half their sum. NaN neighbours do not count, NaN pixels
/// stay. Weights are 16-bit numbers.
void filterWeightedMedian(cv::Mat& disparity, const cv::Mat& left, const WeightedMedianParams& params);

}  // namespace fdp_stereo
