// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8c: fills pixels without disparity from the background.
struct HoleFillingParams {
  bool enabled = false;
};

/// NaN pixels take the smaller of the nearest valid disparities left and right in their row; rows without any take
/// those of the nearest row that has some. A map without any valid pixel stays as it is.
void fillHoles(cv::Mat& disparity);

}  // namespace fdp_stereo
