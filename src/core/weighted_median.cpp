// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/weighted_median.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace fdp_stereo {
namespace {

int colourDistance(const std::uint8_t* a, const std::uint8_t* b, int channels) {
  int sum = 0;
  for (int c = 0; c < channels; ++c) sum += std::abs(a[c] - b[c]);
  return sum;
}

/// exp(-|dI|_1 / gamma) of eq. (11) for |dI|_1 = 0..765.
std::array<float, 766> weightTable(double gamma) {
  std::array<float, 766> table{};
  for (int i = 0; i < 766; ++i) table[i] = gamma > 0.0 ? static_cast<float>(std::exp(-i / gamma)) : 1.0F;
  return table;
}

float weightedMedian(std::vector<std::pair<float, float>>& samples) {
  std::sort(samples.begin(), samples.end());
  float total = 0.0F;
  for (const auto& sample : samples) total += sample.second;
  float sum = 0.0F;
  for (const auto& sample : samples) {
    sum += sample.second;
    if (sum >= 0.5F * total) return sample.first;
  }
  return samples.back().first;
}

}  // namespace

void filterWeightedMedian(cv::Mat& disparity, const cv::Mat& left, const cv::Mat& mask,
                          const WeightedMedianParams& params) {
  if (params.radius <= 0) return;
  const cv::Mat source = disparity.clone();
  const auto weights = weightTable(params.gamma);
  const int channels = left.channels();
#pragma omp parallel
  {
    std::vector<std::pair<float, float>> samples;
#pragma omp for schedule(static)
    for (int y = 0; y < source.rows; ++y) {
      for (int x = 0; x < source.cols; ++x) {
        if (std::isnan(source.at<float>(y, x)) || (params.only_filled && mask.at<std::uint8_t>(y, x) == 0)) continue;
        samples.clear();
        for (int v = std::max(y - params.radius, 0); v <= std::min(y + params.radius, source.rows - 1); ++v) {
          for (int u = std::max(x - params.radius, 0); u <= std::min(x + params.radius, source.cols - 1); ++u) {
            const float d = source.at<float>(v, u);
            if (std::isnan(d)) continue;
            const int distance = colourDistance(left.ptr(y) + x * channels, left.ptr(v) + u * channels, channels);
            samples.emplace_back(d, weights[distance]);
          }
        }
        disparity.at<float>(y, x) = weightedMedian(samples);
      }
    }
  }
}

}  // namespace fdp_stereo
