// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// 255 at the pixels of a disparity map (CV_32FC1 px, NaN = none) that hang in the air between two surfaces at a depth
/// edge, or alone: the disparity climbs or falls on both sides of them, or they have few neighbours of their depth.
/// CV_8UC1.
cv::Mat flyingPixels(const cv::Mat& disparity);

/// The best pixel of every square of `side` px, (-1, -1) where a square has none. usable: CV_8UC1, not 0 = may be
/// taken. confidence: CV_32FC1, or empty; the largest is best, at equal ones that nearest to the centre of the square.
/// CV_32SC2 as (x, y), one per square, the incomplete ones at the edges too.
cv::Mat bestPixels(const cv::Mat& usable, const cv::Mat& confidence, int side);

}  // namespace fdp_stereo
