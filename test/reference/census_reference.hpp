// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include <opencv2/core.hpp>

namespace fdp_stereo {
namespace reference {

/// Number of window positions at which the order of neighbour and centre differs between pixel a of one image and
/// pixel b of another: the Hamming distance of the two codes, without any code.
inline int censusDistance(const cv::Mat& grey_a, cv::Point a, const cv::Mat& grey_b, cv::Point b, int width,
                          int height) {
  const auto at = [](const cv::Mat& image, int x, int y) {
    x = std::min(std::max(x, 0), image.cols - 1);
    y = std::min(std::max(y, 0), image.rows - 1);
    return image.depth() == CV_8U ? int{image.at<std::uint8_t>(y, x)} : int{image.at<std::uint16_t>(y, x)};
  };
  int distance = 0;
  for (int v = -height / 2; v <= height / 2; ++v) {
    for (int u = -width / 2; u <= width / 2; ++u) {
      const bool below_a = at(grey_a, a.x + u, a.y + v) < at(grey_a, a.x, a.y);
      const bool below_b = at(grey_b, b.x + u, b.y + v) < at(grey_b, b.x, b.y);
      if (below_a != below_b) ++distance;
    }
  }
  return distance;
}

}  // namespace reference
}  // namespace fdp_stereo
