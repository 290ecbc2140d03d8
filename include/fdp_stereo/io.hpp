// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Reads a disparity map: .pfm (Pf; inf = none) or .png (16 bit; value / png_scale, 0 = none). CV_32FC1, NaN = none.
/// Throws std::runtime_error naming the file and what is wrong with it.
cv::Mat readDisparity(const std::string& path, double png_scale = 256.0);
/// Writes by extension: .pfm (inf = none) or .png (16 bit x 256, 0 = none).
void writeDisparity(const std::string& path, const cv::Mat& disparity);
/// Reads an image as it is (8 or 16 bit, 1 or 3 channels). Throws std::runtime_error naming the file.
cv::Mat readImage(const std::string& path);
/// Disparity to colours (turbo), black = none; CV_8UC3.
cv::Mat colorize(const cv::Mat& disparity, DisparityRange range);

}  // namespace fdp_stereo
