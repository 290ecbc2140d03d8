// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hole_closing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "parallel.hpp"

namespace fdp_stereo {
namespace {

constexpr int kRadiusPx = 2;
constexpr int kSide = 2 * kRadiusPx + 1;
constexpr double kMinShare = 0.5;  // of the pixels around that are in the image
constexpr float kReachPx = 2.0F;   // from the median: surfaces are slanted

/// The pixels of the map around one.
cv::Rect around(int x, int y, cv::Size size) {
  return cv::Rect(x - kRadiusPx, y - kRadiusPx, kSide, kSide) & cv::Rect(cv::Point(), size);
}

/// What the surface around a hole says of it; NaN where there is no such surface.
float surfaceAt(const cv::Mat& disparity, int x, int y) {
  const cv::Rect window = around(x, y, disparity.size());
  const double needed = kMinShare * window.area();
  std::array<float, kSide * kSide> known{};
  int count = 0;
  for (int v = window.y; v < window.y + window.height; ++v) {
    const auto* row = disparity.ptr<float>(v);
    for (int u = window.x; u < window.x + window.width; ++u) {
      if (!std::isnan(row[u])) known[count++] = row[u];
    }
  }
  if (count < needed) return kInvalidDisparity;
  auto sorted = known;
  std::nth_element(sorted.data(), sorted.data() + count / 2, sorted.data() + count);
  const float median = sorted[count / 2];
  float sum = 0.0F;
  int on_surface = 0;
  for (int i = 0; i < count; ++i) {
    if (std::abs(known[i] - median) > kReachPx) continue;
    sum += known[i];
    ++on_surface;
  }
  return on_surface < needed ? kInvalidDisparity : sum / static_cast<float>(on_surface);
}

}  // namespace

cv::Mat closeHoles(cv::Mat& disparity) {
  const cv::Mat known = disparity.clone();
  cv::Mat closed = cv::Mat::zeros(disparity.size(), CV_8UC1);
  const auto last = static_cast<float>(disparity.cols - 1);
  parallelFor(disparity.rows, [&](int y) {
    const auto* before = known.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      if (!std::isnan(before[x])) continue;
      const float d = surfaceAt(known, x, y);
      const float match = static_cast<float>(x) - d;
      if (!(match >= 0.0F && match <= last)) continue;  // no surface, or the right view cannot see it
      disparity.ptr<float>(y)[x] = d;
      closed.ptr<std::uint8_t>(y)[x] = 255;
    }
  });
  return closed;
}

}  // namespace fdp_stereo
