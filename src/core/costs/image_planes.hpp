// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

constexpr float kUnitsPerGreyLevel = 32.0F;  ///< fixed point of the planes: 1 unit = 1/32 grey level

/// Fixed-point planes of one image, so that rho (eq. 8), AD (eq. 4) or Birchfield-Tomasi is a sum of differences. They
/// are made row by row from the image, which must stay alive and unchanged.
class ImagePlanes {
 public:
  /// (1 - alpha) / 3 * colour, alpha * gradient (3 x 3 Sobel / 4, horizontal and vertical); parts without weight are
  /// left out. A grey image has one channel that counts in full.
  void useRho(const cv::Mat& image, const cv::Mat& grey, double alpha);
  /// colour / 3: AD.
  void useColour(const cv::Mat& image);
  /// Value, and smallest and largest of it and its means with the neighbours in the row (Birchfield and Tomasi 1998).
  void useBirchfieldTomasi(const cv::Mat& grey);
  void clear() { *this = {}; }

  int count() const { return channels_ + (gradient_factor_ > 0 ? 2 : 0) + (birchfield_tomasi_ ? 2 : 0); }
  /// The count() planes of row y, plane c from planes + c * width on.
  void fillRow(int y, std::int16_t* planes) const;

 private:
  void useChannels(const cv::Mat& image, double share);
  void fillChannels(int y, std::int16_t* planes) const;
  void fillGradient(int y, std::int16_t* horizontal, std::int16_t* vertical) const;

  cv::Mat image_;  // headers of the caller's images
  cv::Mat grey_;
  int channels_ = 0;
  std::array<std::int16_t, 256> table_{};  // fixed-point share of a value
  int gradient_factor_ = 0;                // 2^16 units per Sobel step
  bool birchfield_tomasi_ = false;
};

}  // namespace fdp_stereo
