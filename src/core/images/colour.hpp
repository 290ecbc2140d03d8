// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Three times the colour distance, which is whole, is below this.
constexpr int kThirds = 3 * 255 + 1;

/// Three times the mean over the channels (1 or 3) of |a - b|, so that grey images and colour images compare.
inline int colourThirds(const std::uint8_t* a, const std::uint8_t* b, int channels) {
  if (channels == 1) return 3 * std::abs(a[0] - b[0]);
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

/// The colour distance of all stages, in grey levels: what every `gamma` is compared with.
inline float colourDistance(const std::uint8_t* a, const std::uint8_t* b, int channels) {
  return static_cast<float>(colourThirds(a, b, channels)) / 3.0F;
}

/// exp(-distance / gamma) for every colourThirds().
std::array<double, kThirds> colourWeights(double gamma);

/// The grey image in 8 bits: `grey` or `image` itself, or made in `buffer` where neither has 8 bits and one channel.
const cv::Mat& eightBitGrey(const cv::Mat& image, const cv::Mat& grey, cv::Mat& buffer);

}  // namespace fdp_stereo
