// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/image_quality.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace fdp_stereo {
namespace {

constexpr int kRowStep = 8;
constexpr int kSegmentPx = 32;
constexpr int kReachPx = 4;
constexpr double kLaplacianOfNoise = 6.0 * 0.798;  // mean magnitude, for noise of standard deviation 1

/// Mean magnitudes in a part of a row, grey levels.
struct Segment {
  double fine = 0.0;
  double coarse = 0.0;
};

Segment measureSegment(const cv::Mat& grey, int y, int first) {
  const auto* above = grey.ptr<std::uint8_t>(y - 1);
  const auto* here = grey.ptr<std::uint8_t>(y);
  const auto* below = grey.ptr<std::uint8_t>(y + 1);
  int bend[kSegmentPx + 2 * kReachPx];  // vertical second difference
  int sum[kSegmentPx + 2 * kReachPx];
  for (int i = 0; i < kSegmentPx + 2 * kReachPx; ++i) {
    const int x = first - kReachPx + i;
    bend[i] = above[x] - 2 * here[x] + below[x];
    sum[i] = above[x] + here[x] + below[x];
  }
  int fine = 0, coarse = 0;
  for (int i = kReachPx; i < kSegmentPx + kReachPx; ++i) {
    fine += std::abs(bend[i - 1] - 2 * bend[i] + bend[i + 1]);
    coarse += std::abs(sum[i + 1] + sum[i + 2] + sum[i + 3] - sum[i - 1] - sum[i - 2] - sum[i - 3]);
  }
  return {fine / (kLaplacianOfNoise * kSegmentPx), coarse / (9.0 * kSegmentPx)};
}

double quantile(std::vector<double>& values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

ImageQuality measureQuality(const cv::Mat& grey) {
  constexpr double kRounding = 0.2;  // grey levels that rounding alone may cause
  std::vector<double> fine, coarse, ratio;
  for (int y = kRowStep / 2; y < grey.rows - 1; y += kRowStep) {
    for (int x = kReachPx; x + kSegmentPx + kReachPx <= grey.cols; x += kSegmentPx) {
      const Segment segment = measureSegment(grey, y, x);
      fine.push_back(segment.fine);
      coarse.push_back(segment.coarse);
      ratio.push_back(segment.fine / (segment.coarse + kRounding));
    }
  }
  if (fine.empty()) return {};
  std::vector<double> sorted = coarse;
  const double strong = quantile(sorted, 0.9), usual = quantile(sorted, 0.5);
  sorted = fine;
  const double grain = quantile(sorted, 0.2);
  if (usual <= 0.0) return {0.0, 1.0, 1.0, grain};
  double strong_fine = 0.0, strong_coarse = 0.0;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    if (coarse[i] < strong) continue;
    strong_fine += fine[i];
    strong_coarse += coarse[i];
  }
  return {grain / usual, quantile(ratio, 0.5), strong_fine / strong_coarse, grain};
}

}  // namespace fdp_stereo
