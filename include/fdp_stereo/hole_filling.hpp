// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8d: fills pixels without disparity from the background.
struct HoleFillingParams {
  bool enabled = false;
  int max_size = 0;  ///< px; larger holes (4-neighbours) stay; 0 = all are filled
};

/// NaN pixels take the smaller of the nearest valid disparities left and right in their row; rows without any take
/// those of the nearest row that has some. A map without any valid pixel stays as it is.
void fillHoles(cv::Mat& disparity, int max_size = 0);

}  // namespace fdp_stereo
