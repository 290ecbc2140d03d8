// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// 255 where an image (grey, in its full depth of 8 or 16 bits) holds nothing that could be matched, in black borders,
/// covered lenses, blown-out skies and walls: every window of 5 x 5 equal px, or of 15 x 15 px within one grey level;
/// the noise of a sensor is more than that. CV_8UC1.
cv::Mat blindPixels(const cv::Mat& grey);

/// The black frame that rectification leaves: 255 where a blind pixel can be reached from the border of the image along
/// its row or column through black ones alone. Empty where there is next to none. CV_8UC1.
cv::Mat blackFrame(const cv::Mat& grey);

/// Goes on with the picture under a mask: its pixels become those of their row mirrored at the nearest one without mask
/// (that one itself where the mirror image is masked too), rows without such the nearest row with one. A new image;
/// `image` itself where the mask is empty.
cv::Mat extendUnder(const cv::Mat& mask, const cv::Mat& image);

/// Keeps the disparity (CV_32FC1) of blind pixels only where the seen ones beside them in their row explain it: it must
/// lie between the nearest known disparities to the left and to the right. A guess: its confidence is 0 all the same.
void dropUnexplained(const cv::Mat& blind, cv::Mat& disparity);

}  // namespace fdp_stereo
