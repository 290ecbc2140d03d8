// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/guided_filter.hpp"

#include <Eigen/Dense>
#include <array>

#include "parallel.hpp"
#include "simd/local_expansion_kernels.hpp"

namespace fdp_stereo::local_expansion {
namespace {

using Moments = std::array<double, kSymmetricEntries>;

// Entries of v v', upper triangle by rows, v = (1, r, g, b).
Moments outerProduct(const float* v) {
  Moments m{};
  int entry = 0;
  for (int i = 0; i < kGuideChannels; ++i) {
    for (int j = i; j < kGuideChannels; ++j) m[entry++] = static_cast<double>(v[i]) * static_cast<double>(v[j]);
  }
  return m;
}

void accumulate(Moments& sum, const Moments& value, double sign) {
  for (int i = 0; i < kSymmetricEntries; ++i) sum[i] += sign * value[i];
}

void writeInverse(const Moments& sum, double epsilon, float* out) {
  Eigen::Matrix4d m;
  int entry = 0;
  for (int i = 0; i < kGuideChannels; ++i) {
    for (int j = i; j < kGuideChannels; ++j) m(i, j) = m(j, i) = sum[entry++];
  }
  for (int i = 1; i < kGuideChannels; ++i) m(i, i) += sum[0] * epsilon;
  const Eigen::Matrix4d inverse = m.inverse();
  entry = 0;
  for (int i = 0; i < kGuideChannels; ++i) {
    for (int j = i; j < kGuideChannels; ++j) out[entry++] = static_cast<float>(inverse(i, j));
  }
}

void fillChannels(const cv::Mat& image, std::vector<float>& channels) {
  const int count = image.channels();
  channels.assign(image.total() * kGuideChannels, 0.0F);
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* in = image.ptr<std::uint8_t>(y);
    float* out = channels.data() + static_cast<std::size_t>(y) * image.cols * kGuideChannels;
    for (int x = 0; x < image.cols; ++x, in += count, out += kGuideChannels) {
      out[0] = 1.0F;
      for (int c = 0; c < count; ++c) out[c + 1] = static_cast<float>(in[c]) / 255.0F - 0.5F;
    }
  }
}

}  // namespace

FilterGuide makeFilterGuide(const cv::Mat& image, int radius, double epsilon) {
  FilterGuide guide;
  guide.radius = radius;
  guide.size = image.size();
  fillChannels(image, guide.channels);
  guide.inverse.resize(image.total() * kSymmetricEntries);
  const int width = image.cols;
  const int height = image.rows;
  // Bands of rows, so that threads share the work; each starts its column sums afresh.
  constexpr int kBand = 32;
  const int bands = (height + kBand - 1) / kBand;
  const auto filterBand = [&](int band) {
    std::vector<Moments> columns(width, Moments{});
    const auto addRow = [&](int y, double sign) {
      if (y < 0 || y >= height) return;
      const float* row = guide.channels.data() + static_cast<std::size_t>(y) * width * kGuideChannels;
      for (int x = 0; x < width; ++x) accumulate(columns[x], outerProduct(row + x * kGuideChannels), sign);
    };
    for (int y = band * kBand - radius; y < band * kBand + radius; ++y) addRow(y, 1.0);
    for (int y = band * kBand; y < std::min(height, (band + 1) * kBand); ++y) {
      addRow(y + radius, 1.0);
      Moments sum{};
      for (int x = 0; x < std::min(radius, width); ++x) accumulate(sum, columns[x], 1.0);
      for (int x = 0; x < width; ++x) {
        if (x + radius < width) accumulate(sum, columns[x + radius], 1.0);
        writeInverse(sum, epsilon,
                     guide.inverse.data() + (static_cast<std::size_t>(y) * width + x) * kSymmetricEntries);
        if (x >= radius) accumulate(sum, columns[x - radius], -1.0);
      }
      addRow(y - radius, -1.0);
    }
  };
  parallelFor(bands, filterBand, 1);
  return guide;
}

}  // namespace fdp_stereo::local_expansion
