// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "fdp_stereo/types.hpp"
#include "optimizers/local_expansion/labels.hpp"

namespace fdp_stereo::local_expansion {

/// CV_8UC1: 255 where the disparity of a view and that of the other view at the (rounded) match differ by at most
/// max_difference_px, 0 where they do not or the match is outside. `other` is the mirrored other view.
cv::Mat consistentPixels(const Labels& own, const Labels& other, double max_difference_px);

/// Gives every pixel where `consistent` is 0 the plane of the nearest consistent pixel to its left or right in its row,
/// whichever has the smaller disparity at *this* pixel (the background). Donors lie at least one pixel inside the
/// consistent area. Pixels of a row without donor keep their plane.
void fillPlanes(const cv::Mat& consistent, Labels& labels);

/// Gives every pixel where `consistent` is 0 the plane at the weighted median of its window: planes sorted by their
/// disparity at this pixel, weights exp(-|dI| / gamma). radius_px 0 = off.
void filterPlanes(const cv::Mat& image, const cv::Mat& consistent, int radius_px, double gamma, Labels& labels);

/// The disparity map, clipped to the range. CV_32FC1.
cv::Mat disparityOf(const Labels& labels, DisparityRange range);

}  // namespace fdp_stereo::local_expansion
