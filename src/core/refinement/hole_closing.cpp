// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hole_closing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "arguments.hpp"
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

/// Known pixels of each column in the rows around y.
void countColumns(const cv::Mat& disparity, int y, std::vector<int>& counts) {
  counts.assign(disparity.cols, 0);
  for (int v = std::max(0, y - kRadiusPx); v <= std::min(disparity.rows - 1, y + kRadiusPx); ++v) {
    const auto* row = disparity.ptr<float>(v);
    std::transform(row, row + disparity.cols, counts.begin(), counts.begin(),
                   [](float d, int count) { return count + (d == d ? 1 : 0); });
  }
}

/// What the known pixels of the window say; NaN where they are no surface of so many pixels.
float surfaceIn(const cv::Mat& disparity, cv::Rect window, double needed) {
  std::array<float, kSide * kSide> known{};
  int count = 0;
  for (int v = window.y; v < window.y + window.height; ++v) {
    const auto* row = disparity.ptr<float>(v);
    for (int u = window.x; u < window.x + window.width; ++u) {
      if (!std::isnan(row[u])) known[count++] = row[u];
    }
  }
  const auto [least, most] = std::minmax_element(known.data(), known.data() + count);
  if (*most - *least <= kReachPx)
    return std::accumulate(known.data(), known.data() + count, 0.0F) / static_cast<float>(count);
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
  requireMap(disparity, "hole closing");
  const cv::Mat known = disparity.clone();
  cv::Mat closed = cv::Mat::zeros(disparity.size(), CV_8UC1);
  const auto last = static_cast<float>(disparity.cols - 1);
  const auto makeCounts = [] { return std::vector<int>(); };
  parallelFor(disparity.rows, makeCounts, [&](int y, std::vector<int>& counts) {
    countColumns(known, y, counts);
    const auto* before = known.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      if (!std::isnan(before[x])) continue;
      const cv::Rect window = around(x, y, disparity.size());
      const double needed = kMinShare * window.area();
      const auto* column = counts.data() + window.x;
      if (std::accumulate(column, column + window.width, 0) < needed) continue;
      const float d = surfaceIn(known, window, needed);
      const float match = static_cast<float>(x) - d;
      if (!(match >= 0.0F && match <= last)) continue;  // no surface, or the right view cannot see it
      disparity.ptr<float>(y)[x] = d;
      closed.ptr<std::uint8_t>(y)[x] = 255;
    }
  });
  return closed;
}

}  // namespace fdp_stereo
