// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

constexpr float kUnitsPerGreyLevel = 32.0F;  ///< fixed point of the planes: 1 unit = 1/32 grey level

/// Fixed-point planes of one image, so that rho (eq. 8), AD (eq. 4) or Birchfield-Tomasi is a sum of differences.
/// Keeps its memory from image to image.
class ImagePlanes {
 public:
  /// (1 - alpha) / 3 * colour, alpha * gradient (3 x 3 Sobel / 4, horizontal and vertical); parts without weight are
  /// left out. A grey image has one channel that counts in full.
  void makeRho(const cv::Mat& image, const cv::Mat& grey, double alpha);
  /// colour / 3: AD.
  void makeColour(const cv::Mat& image);
  /// Value, and smallest and largest of it and its means with the neighbours in the row (Birchfield and Tomasi 1998).
  void makeBirchfieldTomasi(const cv::Mat& grey);
  void clear() { count_ = 0; }

  int count() const { return count_; }
  const std::int16_t* row(int plane, int y) const { return data_.data() + offset(plane, y); }

 private:
  std::size_t offset(int plane, int y) const { return (static_cast<std::size_t>(plane) * height_ + y) * width_; }
  std::int16_t* row(int plane, int y) { return data_.data() + offset(plane, y); }
  void resize(int planes, const cv::Mat& image);
  void fillColour(const cv::Mat& image, double share);
  void fillGradient(const cv::Mat& grey, double share, int first_plane);

  int count_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::int16_t> data_;
};

/// The grey image in 8 bits: `grey` or `image` itself, or made in `buffer` where neither has 8 bits and one channel.
const cv::Mat& eightBitGrey(const cv::Mat& image, const cv::Mat& grey, cv::Mat& buffer);

}  // namespace fdp_stereo
