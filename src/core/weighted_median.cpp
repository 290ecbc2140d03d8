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
constexpr float kFar = 1e9F;  // beyond every disparity

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

/// Disparities of a window and their weights; a neighbour without disparity weighs nothing.
struct Samples {
  std::vector<float> values;
  std::vector<std::int32_t> weights;
  int count = 0;
  float low = 0.0F, high = 0.0F;
  std::int32_t total = 0;

  explicit Samples(int radius) : values((2 * radius + 1) * (2 * radius + 1)), weights(values.size()) {}

  void start(float centre) {
    count = 0;
    total = 0;
    low = high = centre;
  }

  void add(float value, std::int32_t weight) {
    const bool valid = value == value;
    values[count] = valid ? value : low;
    weights[count] = valid ? weight : 0;
    total += weights[count];
    low = value < low ? value : low;
    high = value > high ? value : high;
    ++count;
  }

  /// Narrows (low, high] around the median by bisection until it is shorter than 1/1024 px: no sorting.
  float median() const {
    const WeightedMedianKernels& kernels = FDP_STEREO_SELECT(weightedMedianKernels);
    float below = low, above = high;
    if (2 * kernels.weightUpTo(values.data(), weights.data(), count, low) >= total) return low;
    while (above - below >= 1.0F / 1024.0F) {
      const float middle = 0.5F * (below + above);
      if (2 * kernels.weightUpTo(values.data(), weights.data(), count, middle) >= total) {
        above = middle;
      } else {
        below = middle;
      }
    }
    float result = above;
    for (int i = 0; i < count; ++i) {
      if (weights[i] > 0 && values[i] > below && values[i] < result) result = values[i];
    }
    return result;
  }
};

void gather(const cv::Mat& disparity, const cv::Mat& left, int y, int x, int radius,
            const std::array<std::int32_t, 766>& table, Samples& samples) {
  const int channels = left.channels();
  const auto* centre = left.ptr<std::uint8_t>(y) + x * channels;
  const int first = std::max(x - radius, 0), last = std::min(x + radius, disparity.cols - 1);
  samples.start(disparity.ptr<float>(y)[x]);
  for (int v = std::max(y - radius, 0); v <= std::min(y + radius, disparity.rows - 1); ++v) {
    const auto* d = disparity.ptr<float>(v);
    const auto* pixels = left.ptr<std::uint8_t>(v);
    for (int u = first; u <= last; ++u) {
      samples.add(d[u], table[colourDistance(centre, pixels + u * channels, channels)]);
    }
  }
}

/// Smallest and largest of the valid disparities of three neighbours in each column, then the largest difference over
/// three columns: edges[x] != 0 where it exceeds min_range.
void findEdges(const cv::Mat& disparity, int y, float min_range, std::vector<float>& low, std::vector<float>& high,
               std::uint8_t* edges) {
  const int width = disparity.cols;
  const float* rows[3] = {disparity.ptr<float>(std::max(y - 1, 0)), disparity.ptr<float>(y),
                          disparity.ptr<float>(std::min(y + 1, disparity.rows - 1))};
  // A NaN compares false and leaves the extremes as they are.
  for (int x = 0; x < width; ++x) {
    float smallest = kFar, largest = -kFar;
    for (const float* row : rows) {
      smallest = row[x] < smallest ? row[x] : smallest;
      largest = row[x] > largest ? row[x] : largest;
    }
    low[x + 1] = smallest;
    high[x + 1] = largest;
  }
  low[0] = low[width + 1] = kFar;
  high[0] = high[width + 1] = -kFar;
  for (int x = 0; x < width; ++x) {
    const float smallest = std::min(low[x], std::min(low[x + 1], low[x + 2]));
    const float largest = std::max(high[x], std::max(high[x + 1], high[x + 2]));
    edges[x] = largest - smallest > min_range ? 1 : 0;
  }
}

}  // namespace

void filterWeightedMedian(cv::Mat& disparity, const cv::Mat& left, const cv::Mat& mask,
                          const WeightedMedianParams& params) {
  if (params.radius <= 0) return;
  const cv::Mat source = disparity.clone();
  const auto table = weightTable(params.gamma);
  const float min_range = params.min_range_px > 0.0 ? static_cast<float>(params.min_range_px) : -1.0F;
#pragma omp parallel
  {
    Samples samples(params.radius);
    std::vector<float> low(source.cols + 2), high(source.cols + 2);
    std::vector<std::uint8_t> wanted(source.cols);
#pragma omp for schedule(dynamic, 8)
    for (int y = 0; y < source.rows; ++y) {
      findEdges(source, y, min_range, low, high, wanted.data());
      const auto* d = source.ptr<float>(y);
      const auto* filled = mask.empty() ? nullptr : mask.ptr<std::uint8_t>(y);
      for (int x = 0; x < source.cols; ++x) {
        const bool skip = params.only_filled && (filled == nullptr || filled[x] == 0);
        if (wanted[x] == 0 || skip || std::isnan(d[x])) continue;
        gather(source, left, y, x, params.radius, table, samples);
        disparity.ptr<float>(y)[x] = samples.median();
      }
    }
  }
}

}  // namespace fdp_stereo
