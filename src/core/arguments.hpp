// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Throws std::invalid_argument, which names the stage, for anything but a CV_32FC1 map that has pixels.
void requireMap(const cv::Mat& map, const char* stage);

/// The same, and for a map of another size than the stage's first one.
void requireMap(const cv::Mat& map, cv::Size size, const char* stage);

/// Throws std::invalid_argument for anything but an image of that size with 1 or 3 channels of 8 bits.
void requireImage(const cv::Mat& image, cv::Size size, const char* stage);

/// Seeds whose numbers are finite.
Seeds finiteSeeds(const Seeds& seeds);

}  // namespace fdp_stereo
