// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/blind_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace {

/// 255 in every window of side x side px whose values differ by at most `difference`.
cv::Mat flatWindows(const cv::Mat& grey, int side, double difference) {
  const cv::Mat window(side, side, CV_8UC1, cv::Scalar(1));
  cv::Mat largest, smallest, flat;
  cv::dilate(grey, largest, window);
  cv::erode(grey, smallest, window);
  cv::dilate(largest - smallest <= difference, flat, window);
  return flat;
}

}  // namespace

cv::Mat blindPixels(const cv::Mat& grey) { return flatWindows(grey, 5, 0.0) | flatWindows(grey, 15, 1.0); }

void dropUnexplained(const cv::Mat& blind, cv::Mat& disparity) {
  constexpr float kTolerancePx = 1.0F;
  std::vector<float> after(blind.cols + 1);  // the next known disparity from x on
  for (int y = 0; y < blind.rows; ++y) {
    const auto* hidden = blind.ptr<std::uint8_t>(y);
    auto* d = disparity.ptr<float>(y);
    const auto carry = [&](int x, int neighbour, float known) {  // from one pixel to the next, but not out of a run
      if (hidden[x] != 0) return known;
      if (!std::isnan(d[x])) return d[x];
      return hidden[neighbour] != 0 ? kInvalidDisparity : known;
    };
    const int last = blind.cols - 1;
    after[last + 1] = kInvalidDisparity;
    for (int x = last; x >= 0; --x) after[x] = carry(x, std::min(x + 1, last), after[x + 1]);
    float before = kInvalidDisparity;
    for (int x = 0; x <= last; ++x) {
      before = carry(x, std::max(x - 1, 0), before);
      if (hidden[x] == 0) continue;
      const bool explained =
          d[x] >= std::min(before, after[x]) - kTolerancePx && d[x] <= std::max(before, after[x]) + kTolerancePx;
      if (std::isnan(before) || std::isnan(after[x]) || !explained) d[x] = kInvalidDisparity;
    }
  }
}

}  // namespace fdp_stereo
