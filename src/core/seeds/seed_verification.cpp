// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seeds/seed_verification.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fdp_stereo {
namespace {

constexpr int kRing = 7;          // px from the seed to the outermost windows
constexpr int kWindowRadius = 1;  // windows of 3 x 3 px: larger ones hold on to the edge
constexpr int kSearchPx = 14;
constexpr int kRadius = kRing + kWindowRadius;
constexpr int kSide = 2 * kRadius + 1;
constexpr int kWide = kSide + 2 * kSearchPx;  // columns of the right strip
constexpr int kMargin = 2;                    // px of the patch that gain and offset do not look at
constexpr int kSteps = 2 * kSearchPx + 1;

using Patch = std::array<float, kSide * kSide>;
using Strip = std::array<float, kSide * kWide>;

/// Windows at 0, 2, 4 and 7 px from the seed, in eight directions.
std::array<cv::Point, 25> windowCentres() {
  std::array<cv::Point, 25> centres{};
  std::size_t k = 1;
  for (const int ring : {2, 4, kRing}) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        if (i != 0 || j != 0) centres[k++] = {ring * i, ring * j};
      }
    }
  }
  return centres;
}

Patch readPatch(const cv::Mat& grey, cv::Point at) {
  Patch patch;
  for (int j = 0; j < kSide; ++j) {
    const auto* row = grey.ptr<uchar>(std::clamp(at.y + j - kRadius, 0, grey.rows - 1));
    for (int i = 0; i < kSide; ++i) patch[j * kSide + i] = row[std::clamp(at.x + i - kRadius, 0, grey.cols - 1)];
  }
  return patch;
}

/// Right pixels around `column`, between two columns by linear interpolation.
Strip readStrip(const cv::Mat& grey, int y, float column) {
  const int base = static_cast<int>(std::floor(column));
  const float share = column - static_cast<float>(base);
  Strip strip;
  for (int j = 0; j < kSide; ++j) {
    const auto* row = grey.ptr<uchar>(std::clamp(y + j - kRadius, 0, grey.rows - 1));
    for (int i = 0; i < kWide; ++i) {
      const int x = base + i - kRadius - kSearchPx;
      const float a = row[std::clamp(x, 0, grey.cols - 1)];
      const float b = row[std::clamp(x + 1, 0, grey.cols - 1)];
      strip[j * kWide + i] = a + share * (b - a);
    }
  }
  return strip;
}

/// Gives the strip the mean and the contrast of the left patch, as they are at the seed's disparity.
void equalise(const Patch& left, Strip& strip) {
  double sum_left = 0.0;
  double sum_right = 0.0;
  double squares_left = 0.0;
  double squares_right = 0.0;
  for (int j = kMargin; j < kSide - kMargin; ++j) {
    for (int i = kMargin; i < kSide - kMargin; ++i) {
      const double l = left[j * kSide + i];
      const double r = strip[j * kWide + i + kSearchPx];
      sum_left += l;
      sum_right += r;
      squares_left += l * l;
      squares_right += r * r;
    }
  }
  const double n = (kSide - 2 * kMargin) * (kSide - 2 * kMargin);
  const double variance_left = std::max(1.0, squares_left / n - sum_left * sum_left / (n * n));
  const double variance_right = std::max(1.0, squares_right / n - sum_right * sum_right / (n * n));
  const auto gain = static_cast<float>(std::sqrt(variance_left / variance_right));
  const auto offset = static_cast<float>(sum_left / n) - gain * static_cast<float>(sum_right / n);
  for (float& value : strip) value = gain * value + offset;
}

/// |disparity that the window finds - disparity of the seed|, to a fraction of a pixel.
float deviation(const Patch& left, const Strip& right, cv::Point centre) {
  std::array<float, kSteps> costs{};
  for (int j = -kWindowRadius; j <= kWindowRadius; ++j) {
    const int row = kRadius + centre.y + j;
    for (int i = -kWindowRadius; i <= kWindowRadius; ++i) {
      const int column = kRadius + centre.x + i;
      const float l = left[row * kSide + column];
      const float* r = right.data() + row * kWide + column;
      for (int s = 0; s < kSteps; ++s) costs[s] += (l - r[s]) * (l - r[s]);
    }
  }
  const auto best = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  auto shift = static_cast<float>(best - kSearchPx);
  if (best > 0 && best + 1 < kSteps) {
    const float curvature = costs[best - 1] - 2.0F * costs[best] + costs[best + 1];
    if (curvature > 0.0F) shift += 0.5F * (costs[best - 1] - costs[best + 1]) / curvature;
  }
  return std::min(std::abs(shift), kMaxDeviationPx);
}

}  // namespace

float windowDeviation(const cv::Mat& left_grey, const cv::Mat& right_grey, cv::Point at, float disparity) {
  static const std::array<cv::Point, 25> centres = windowCentres();
  const Patch left = readPatch(left_grey, at);
  Strip right = readStrip(right_grey, at.y, static_cast<float>(at.x) - disparity);
  equalise(left, right);
  float sum = 0.0F;
  for (const cv::Point centre : centres) sum += deviation(left, right, centre);
  return sum / static_cast<float>(centres.size());
}

}  // namespace fdp_stereo
