// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8c: closes the tiny holes of one surface.
struct HoleClosingParams {
  bool enabled = true;
};

/// Pixels without disparity where half of the 5 x 5 px around lie on one surface, about their median, get the mean of
/// those; nothing is carried over an edge. Gives the pixels that it closed: CV_8UC1, 255 = closed.
cv::Mat closeHoles(cv::Mat& disparity);

}  // namespace fdp_stereo
