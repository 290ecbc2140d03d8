// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/view_change.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

#include "images/image_quality.hpp"
#include "parallel.hpp"

namespace fdp_stereo {
namespace {

constexpr float kRounding = 0.5F;  // of what becomes whole

/// The place of the median among the bins of a histogram, with fractions.
template <typename Counts>
double medianOf(const Counts& counts) {
  const auto total = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  std::int64_t below = 0;
  std::size_t bin = 0;
  while (bin + 1 < counts.size() && 2 * (below + counts[bin]) < total) below += counts[bin++];
  const auto rest = 0.5 * static_cast<double>(total) - static_cast<double>(below);
  return static_cast<double>(bin) + rest / static_cast<double>(std::max<std::int64_t>(counts[bin], 1));
}

template <typename Value>
double ratioOf(const cv::Mat& image, const cv::Mat& mean) {
  constexpr std::int64_t kSamples = 50000;
  constexpr double kFarthest = 0.25, kBins = 1024.0;  // from 1, and per 1
  const cv::Scalar average = cv::mean(image);         // of whole numbers: the same bits everywhere
  const auto dark = static_cast<float>(0.25 * *std::max_element(average.val, average.val + 4));
  const auto count = static_cast<std::int64_t>(image.cols) * image.channels();
  const std::int64_t step = std::max<std::int64_t>(count * image.rows / kSamples, 1) | 1;
  std::array<std::int64_t, static_cast<std::size_t>(2.0 * kFarthest * kBins)> counts{};
  for (std::int64_t i = 0; i < count * image.rows; i += step) {
    const auto y = static_cast<int>(i / count), x = static_cast<int>(i % count);
    const float before = mean.ptr<float>(y)[x];
    if (before <= dark) continue;
    const double ratio = image.ptr<Value>(y)[x] / static_cast<double>(before);
    const double place = (ratio - 1.0 + kFarthest) * kBins;
    ++counts[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(counts.size() - 1)))];
  }
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0}) == 0
             ? 1.0
             : 1.0 - kFarthest + medianOf(counts) / kBins;
}

}  // namespace

double brightnessRatio(const cv::Mat& image, const cv::Mat& mean) {
  return image.depth() == CV_8U ? ratioOf<std::uint8_t>(image, mean) : ratioOf<std::uint16_t>(image, mean);
}

cv::Mat changesFrom(const cv::Mat& mean, const cv::Mat& grey) {
  cv::Mat changes(grey.size(), CV_8UC1);
  parallelFor(grey.rows, [&](int y) {
    const auto* now = grey.ptr<std::uint8_t>(y);
    const auto* before = mean.ptr<float>(y);
    auto* change = changes.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const float difference = std::abs(static_cast<float>(now[x]) - before[x]) * kChangeSteps + kRounding;
      change[x] = static_cast<std::uint8_t>(std::min(static_cast<int>(difference), kLargestChange));
    }
  });
  return changes;
}

NoiseLevels measureNoise(const cv::Mat& grey, const cv::Mat& before, double light) {
  constexpr int kRowStep = 2;
  constexpr std::int64_t kEnough = 500;          // pixels of a level
  constexpr int kDarkest = 2, kBrightest = 253;  // values beyond are cut off, and their noise with them
  constexpr double kMedianOfNormal = 0.6745;
  constexpr double kCorrelated = 2.0;                    // resampled noise is smooth
  constexpr double kLeastNoise = 0.5, kMostNoise = 8.0;  // grey levels
  using Counts = std::array<std::int64_t, 512>;          // of whole changes, rounded
  std::array<Counts, NoiseLevels().size()> counts{};
  const auto factor = static_cast<float>(light);
  for (int y = 0; y < grey.rows; y += kRowStep) {
    const auto* now = grey.ptr<std::uint8_t>(y);
    const auto* old = before.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      if (now[x] < kDarkest || now[x] > kBrightest) continue;
      const float change = std::abs(static_cast<float>(now[x]) - factor * static_cast<float>(old[x]));
      ++counts[noiseLevel(now[x])][std::min(static_cast<std::size_t>(change + kRounding), Counts().size() - 1)];
    }
  }
  Counts all{};
  for (const Counts& level : counts) std::transform(all.begin(), all.end(), level.begin(), all.begin(), std::plus<>());
  const auto deviation = [](const Counts& seen) {
    const double bin = medianOf(seen);
    return (bin < 1.0 ? 0.5 * bin : bin - kRounding) / (kMedianOfNormal * std::sqrt(2.0));
  };
  const double plainest = kCorrelated * measureQuality(grey).grain;
  NoiseLevels noise{};
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const bool enough = std::accumulate(counts[i].begin(), counts[i].end(), std::int64_t{0}) >= kEnough;
    const double change = std::max(deviation(all), enough ? deviation(counts[i]) : 0.0);
    noise[i] = std::clamp(std::min(change, plainest), kLeastNoise, kMostNoise);
  }
  return noise;
}

}  // namespace fdp_stereo
