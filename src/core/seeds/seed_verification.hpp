// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Largest deviation that one window counts, px; that of a patch which cannot be compared.
constexpr float kMaxDeviationPx = 2.0F;

/// Mean distance (0 .. kMaxDeviationPx) between `disparity` and the disparities that 25 small windows, up to 7 px
/// around left pixel `at`, find for themselves within 14 px of it. Small on a surface; large where a depth edge, a
/// repetition or mere noise runs through the patch: most wrong seeds sit on the far side of an edge that was matched
/// rightly. Images: CV_8UC1, of one size and with aligned rows. Gain and offset of the grey values are free.
float windowDeviation(const cv::Mat& left_grey, const cv::Mat& right_grey, cv::Point at, float disparity);

}  // namespace fdp_stereo
