// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// The confidence from which an answer may tell that a ray is free.
constexpr double kSureOfFree = 0.85;

/// How far rays are known to be free, on a grid of squares of `spacing` px, the incomplete ones at the right and lower
/// edge too: as a disparity (px), down to which everything between the camera and it is free; NaN = not known.
///
/// A square whose pixels are answered is free down to the nearest answer in it and within `spacing` px around it, less
/// 1 px. A square without is free where known ones enclose it along its row or its column: down to the nearest answer
/// on that way, less the bulge that the gap could hide, half a ball as wide as the gap.
///
/// disparity: CV_32FC1 px as published (depth is proportional to 1 / disparity), NaN = none. trusted: CV_8UC1, 0 = the
/// answer bounds what is free but does not tell that anything is; empty = all are trusted.
cv::Mat freeDisparity(const cv::Mat& disparity, const cv::Mat& trusted, double focal_px, int spacing);

/// The pixel whose ray stands for a square.
cv::Point rayPixel(cv::Point square, int spacing, cv::Size image);

}  // namespace fdp_stereo
