// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Longest side of an image or map that is read, px; a header that claims more is refused before anything is allocated.
constexpr int kMaxImageSide = 32768;
/// Most pixels of an image that is read, for the same reason.
constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 27;

/// Reads a disparity map, H x W, CV_32FC1 px, NaN = none: .pfm (one channel, either byte order; a value that is not
/// finite = none) or .png (grey, 16 or 8 bit; value / png_scale, 0 = none). Throws std::runtime_error naming the file
/// and what is wrong with it: missing, truncated, another type, a side beyond kMaxImageSide.
cv::Mat readDisparity(const std::string& path, double png_scale = 256.0);
/// Writes CV_32FC1 px by extension: .pfm (float, inf = none) or .png (16 bit x 256, 0 = none; a disparity below 1/256
/// px becomes 1/256). Throws std::runtime_error for another extension, a file that cannot be written, or a map that PNG
/// cannot hold (negative, or 256 px and more).
void writeDisparity(const std::string& path, const cv::Mat& disparity);

/// Whether the extension of `path` is one that writeDisparity() knows.
bool isDisparityName(const std::string& path);

/// Reads a PNG, JPEG, TIFF, BMP, WebP or PNM image as it is: CV_8U or CV_16U, 1 or 3 (BGR; transparency dropped)
/// channels. Throws std::runtime_error naming the file and what is wrong with it. Pipes can be read, too.
cv::Mat readImage(const std::string& path);
/// The mask that a picture (8U or 16U, any channels) shows: CV_8UC1, 255 where it is at least half as bright as white
/// in any channel.
cv::Mat toMask(const cv::Mat& picture);
/// The mask of a picture's file, for images of `size` px; empty where `path` is. Throws std::runtime_error naming the
/// file.
cv::Mat readMask(const std::string& path, cv::Size size);
/// The same as readImage() from the bytes of such a file; `name` stands for it in errors. More than max_pixels are
/// refused before anything is decoded.
cv::Mat decodeImageFile(std::string_view bytes, const std::string& name, std::int64_t max_pixels = kMaxImagePixels);
/// Whether the extension of `path` is one that writeImage() knows: PNG, JPEG, TIFF, BMP, WebP or PNM.
bool isImageName(const std::string& path);
/// Writes an image by the extension of `path`. Throws std::runtime_error naming the file.
void writeImage(const std::string& path, const cv::Mat& image);

/// Writes a file that gets its name when it is whole; meanwhile it is called PATH.partial. Pipes and devices are
/// written in place. Throws std::runtime_error naming the file.
void writeFile(const std::string& path, std::string_view bytes);

/// Reads seeds of the left image: .pfm or .png like readDisparity(), one seed per pixel that has a disparity; else
/// text, one "x y d [trust]" per line in px, trust 0..1 (1 if left out), '#' begins a comment. A map must have
/// `image_size` unless that is empty. Throws std::runtime_error naming file and line.
Seeds readSeeds(const std::string& path, cv::Size image_size = {});

/// 255 where a CV_32FC1 map is NaN, 0 elsewhere; CV_8UC1.
cv::Mat noneMask(const cv::Mat& map);
/// Disparity to colours (turbo, red = near), black = none; CV_8UC3.
cv::Mat colorize(const cv::Mat& disparity, DisparityRange range);
/// Confidence (CV_32FC1, 0..1) to grey levels 0..255; CV_8UC1, NaN = 0.
cv::Mat confidenceToGrey(const cv::Mat& confidence);

}  // namespace fdp_stereo
