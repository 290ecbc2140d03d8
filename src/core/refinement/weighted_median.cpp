// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/weighted_median.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "parallel.hpp"
#include "simd/weighted_median_kernels.hpp"

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

/// Disparity and image with a border wide enough for the windows and vectors of every pixel: NaN beyond the map.
class PaddedSource {
 public:
  PaddedSource(const cv::Mat& disparity, const cv::Mat& left, int radius) : radius_(radius) {
    const int beyond = radius + kMedianLanes;
    cv::copyMakeBorder(disparity, disparity_, radius, radius, radius, beyond, cv::BORDER_CONSTANT, kInvalidDisparity);
    cv::Mat plane;
    for (int c = 0; c < left.channels(); ++c) {
      cv::extractChannel(left, plane, c);
      planes_.emplace_back();
      cv::copyMakeBorder(plane, planes_.back(), radius, radius, radius, beyond, cv::BORDER_REPLICATE);
    }
  }

  /// Row y of the map itself.
  const float* row(int y) const { return disparity_.ptr<float>(y + radius_) + radius_; }

  MedianWindow window(int y, int x, const std::int32_t* table) const {
    MedianWindow window{};
    window.disparity = disparity_.ptr<float>(y) + x;
    window.disparity_stride = static_cast<std::ptrdiff_t>(disparity_.step1());
    window.plane_stride = static_cast<std::ptrdiff_t>(planes_[0].step1());
    window.channels = static_cast<int>(planes_.size());
    window.side = 2 * radius_ + 1;
    for (int c = 0; c < window.channels; ++c) {
      window.planes[c] = planes_[c].ptr<std::uint8_t>(y) + x;
      window.colour[c] = planes_[c].ptr<std::uint8_t>(y + radius_)[x + radius_];
    }
    window.centre = row(y)[x];
    window.table = table;
    return window;
  }

 private:
  int radius_;
  cv::Mat disparity_;
  std::vector<cv::Mat> planes_;
};

/// Smallest and largest of the valid disparities of three neighbours in each column, then the largest difference over
/// three columns: edges[x] != 0 where it exceeds min_range.
void findEdges(const PaddedSource& source, int y, int width, float min_range, std::vector<float>& low,
               std::vector<float>& high, std::uint8_t* edges) {
  const float* rows[3] = {source.row(y - 1), source.row(y), source.row(y + 1)};
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

/// Buffers of one thread.
struct Scratch {
  std::vector<float> values, low, high;
  std::vector<std::int32_t> weights;
  std::vector<std::uint8_t> wanted;

  Scratch(int side, int width) : low(width + 2), high(width + 2), wanted(width) {
    const int lanes = (side + kMedianLanes - 1) / kMedianLanes * kMedianLanes;
    values.resize(static_cast<std::size_t>(side) * lanes);
    weights.resize(values.size());
  }
};

}  // namespace

void filterWeightedMedian(cv::Mat& disparity, const cv::Mat& left, const cv::Mat& mask,
                          const WeightedMedianParams& params) {
  if (params.radius <= 0) return;
  const PaddedSource source(disparity, left, params.radius);
  const auto table = weightTable(params.gamma);
  const float min_range = params.min_range_px > 0.0 ? static_cast<float>(params.min_range_px) : -1.0F;
  const WeightedMedianKernels& kernels = FDP_STEREO_SELECT(weightedMedianKernels);
  const int width = disparity.cols;
  const auto makeScratch = [&] { return Scratch(2 * params.radius + 1, width); };
  parallelFor(disparity.rows, makeScratch, [&](int y, Scratch& scratch) {
    findEdges(source, y, width, min_range, scratch.low, scratch.high, scratch.wanted.data());
    auto* d = disparity.ptr<float>(y);
    const auto* filled = mask.empty() ? nullptr : mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < width; ++x) {
      const bool skip = params.only_filled && (filled == nullptr || filled[x] == 0);
      if (scratch.wanted[x] == 0 || skip || std::isnan(d[x])) continue;
      d[x] = kernels.weightedMedian(source.window(y, x, table.data()), scratch.values.data(), scratch.weights.data());
    }
  });
}

}  // namespace fdp_stereo
