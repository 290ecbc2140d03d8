// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// 255 where an image (grey, in its full depth of 8 or 16 bits) holds nothing that could be matched, in black borders,
/// covered lenses, blown-out skies and walls: every window of 5 x 5 equal px, or of 15 x 15 px within one grey level;
/// the noise of a sensor is more than that. CV_8UC1.
cv::Mat blindPixels(const cv::Mat& grey);

/// Keeps the disparity (CV_32FC1) of blind pixels only where the seen ones beside them in their row explain it: it must
/// lie between the nearest known disparities to the left and to the right. A guess: its confidence is 0 all the same.
void dropUnexplained(const cv::Mat& blind, cv::Mat& disparity);

}  // namespace fdp_stereo
