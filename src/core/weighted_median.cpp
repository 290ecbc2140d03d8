// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/weighted_median.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "kernels/weighted_median_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr double kUnitWeight = 4096.0;

/// exp(-|dI|_1 / gamma) of eq. (11) for |dI|_1 = 0..765, in 1/4096.
std::array<std::int32_t, 766> weightTable(double gamma) {
  std::array<std::int32_t, 766> table{};
  for (int i = 0; i < 766; ++i) {
    const double weight = gamma > 0.0 ? std::exp(-i / gamma) : 1.0;
    table[i] = static_cast<std::int32_t>(std::lround(weight * kUnitWeight));
  }
  return table;
}

int colourDistance(const std::uint8_t* a, const std::uint8_t* b, int channels) {
  int sum = 0;
  for (int c = 0; c < channels; ++c) sum += std::abs(a[c] - b[c]);
  return sum;
}

/// Disparities of a window and their weights.
struct Samples {
  std::vector<float> values;
  std::vector<std::int32_t> weights;

  void clear() {
    values.clear();
    weights.clear();
  }

  /// Narrows (low, high] around the median by bisection until it holds one value only: no sorting.
  float median() const {
    const WeightedMedianKernels& kernels = FDP_STEREO_SELECT(weightedMedianKernels);
    const int count = static_cast<int>(values.size());
    float low = *std::min_element(values.begin(), values.end());
    float high = *std::max_element(values.begin(), values.end());
    const std::int32_t total = kernels.weightUpTo(values.data(), weights.data(), count, high);
    if (2 * kernels.weightUpTo(values.data(), weights.data(), count, low) >= total) return low;
    for (float middle = 0.5F * (low + high); middle > low && middle < high; middle = 0.5F * (low + high)) {
      if (2 * kernels.weightUpTo(values.data(), weights.data(), count, middle) >= total) {
        high = middle;
      } else {
        low = middle;
      }
      if (high - low < 1.0F / 1024.0F) break;
    }
    float result = high;
    for (const float value : values) {
      if (value > low && value < result) result = value;
    }
    return result;
  }
};

void gather(const cv::Mat& disparity, const cv::Mat& left, int y, int x, int radius,
            const std::array<std::int32_t, 766>& table, Samples& samples) {
  const int channels = left.channels();
  const auto* centre = left.ptr<std::uint8_t>(y) + x * channels;
  samples.clear();
  for (int v = std::max(y - radius, 0); v <= std::min(y + radius, disparity.rows - 1); ++v) {
    const auto* d = disparity.ptr<float>(v);
    const auto* pixels = left.ptr<std::uint8_t>(v);
    for (int u = std::max(x - radius, 0); u <= std::min(x + radius, disparity.cols - 1); ++u) {
      if (std::isnan(d[u])) continue;
      samples.values.push_back(d[u]);
      samples.weights.push_back(table[colourDistance(centre, pixels + u * channels, channels)]);
    }
  }
}

/// Largest difference between the disparities of the 3 x 3 px around.
float rangeAround(const cv::Mat& disparity, int y, int x) {
  float low = disparity.at<float>(y, x), high = low;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, disparity.rows - 1); ++v) {
    const auto* d = disparity.ptr<float>(v);
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, disparity.cols - 1); ++u) {
      low = std::fmin(low, d[u]);
      high = std::fmax(high, d[u]);
    }
  }
  return high - low;
}

}  // namespace

void filterWeightedMedian(cv::Mat& disparity, const cv::Mat& left, const cv::Mat& mask,
                          const WeightedMedianParams& params) {
  if (params.radius <= 0) return;
  const cv::Mat source = disparity.clone();
  const auto table = weightTable(params.gamma);
  const auto min_range = static_cast<float>(params.min_range_px);
#pragma omp parallel
  {
    Samples samples;
#pragma omp for schedule(dynamic, 8)
    for (int y = 0; y < source.rows; ++y) {
      for (int x = 0; x < source.cols; ++x) {
        if (std::isnan(source.at<float>(y, x))) continue;
        const bool filled = !mask.empty() && mask.at<std::uint8_t>(y, x) != 0;
        if (!filled && (params.only_filled || (min_range > 0.0F && rangeAround(source, y, x) <= min_range))) continue;
        gather(source, left, y, x, params.radius, table, samples);
        disparity.at<float>(y, x) = samples.median();
      }
    }
  }
}

}  // namespace fdp_stereo
