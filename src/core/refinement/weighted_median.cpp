// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/weighted_median.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "arguments.hpp"
#include "parallel.hpp"
#include "simd/weighted_median_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr float kFar = 1e9F;                // beyond every disparity
constexpr double kStepsPerPx = 64.0;        // of the samples
constexpr double kMostSteps = 65000.0;      // between the smallest and the largest
constexpr std::int16_t kSmallest = -32767;  // sample

/// exp(-|dI| / gamma) of eq. (11) for the sum of the channels' differences; alike for all where gamma is 0.
MedianWeight weightOf(double gamma, int channels, int side) {
  MedianWeight weight{};
  weight.largest = static_cast<std::uint16_t>(65535 / (side * side));
  if (gamma > 0.0) weight.decay = makeDecay(channels * gamma);
  return weight;
}

/// Disparities of a map as whole numbers.
class SampleScale {
 public:
  explicit SampleScale(const cv::Mat& disparity) {
    double smallest = 0.0, largest = 0.0;
    cv::minMaxLoc(disparity, &smallest, &largest, nullptr, nullptr, disparity == disparity);
    offset_ = static_cast<float>(smallest);
    steps_ = static_cast<float>(std::min(kStepsPerPx, kMostSteps / std::max(largest - smallest, 1.0)));
  }
  void toSamples(const float* disparity, int count, std::int16_t* samples) const {
    for (int x = 0; x < count; ++x) {
      const float d = disparity[x] == disparity[x] ? disparity[x] : offset_;
      const float steps = (d - offset_) * steps_ + 0.5F;
      const auto sample = static_cast<std::int16_t>(static_cast<std::int32_t>(steps) + kSmallest);
      samples[x] = disparity[x] == disparity[x] ? sample : kNoSample;
    }
  }
  float toDisparity(std::int16_t sample) const { return offset_ + static_cast<float>(sample - kSmallest) / steps_; }

 private:
  float offset_, steps_;
};

/// Samples and image with a border wide enough for the windows and vectors of every pixel: no samples beyond the map.
class PaddedSource {
 public:
  PaddedSource(const cv::Mat& disparity, const SampleScale& scale, const cv::Mat& left, int radius)
      : radius_(radius),
        samples_(disparity.rows + 2 * radius + 1, disparity.cols + 2 * radius + kMedianLanes, CV_16SC1) {
    samples_.setTo(kNoSample);
    parallelFor(disparity.rows, [&](int y) {
      scale.toSamples(disparity.ptr<float>(y), disparity.cols, samples_.ptr<std::int16_t>(y + radius) + radius);
    });
    cv::Mat plane;
    for (int c = 0; c < left.channels(); ++c) {
      cv::extractChannel(left, plane, c);
      planes_.emplace_back();
      cv::copyMakeBorder(plane, planes_.back(), radius, radius + 1, radius, radius + kMedianLanes,
                         cv::BORDER_REPLICATE);
    }
  }

  MedianWindow window(int y, int x) const {
    MedianWindow window{};
    window.samples = samples_.ptr<std::int16_t>(y) + x;
    window.sample_stride = static_cast<std::ptrdiff_t>(samples_.step1());
    window.plane_stride = static_cast<std::ptrdiff_t>(planes_[0].step1());
    window.channels = static_cast<int>(planes_.size());
    window.side = 2 * radius_ + 1;
    for (int c = 0; c < window.channels; ++c) {
      window.planes[c] = planes_[c].ptr<std::uint8_t>(y) + x;
      window.colour[c] = planes_[c].ptr<std::uint8_t>(y + radius_)[x + radius_];
    }
    return window;
  }
  std::int16_t centre(int y, int x) const { return samples_.ptr<std::int16_t>(y + radius_)[x + radius_]; }

 private:
  int radius_;
  cv::Mat samples_;  // CV_16SC1
  std::vector<cv::Mat> planes_;
};

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

/// Buffers of one thread.
struct Scratch {
  std::vector<float> low, high;
  std::vector<std::int16_t> values;
  std::vector<std::uint16_t> weights;
  std::vector<std::uint8_t> wanted;

  Scratch(int side, int width) : low(width + 2), high(width + 2), wanted(width) {
    const int lanes = (side + kMedianLanes - 1) / kMedianLanes * kMedianLanes;
    values.resize(static_cast<std::size_t>(side + 1) * lanes);
    weights.resize(values.size());
  }
};

}  // namespace

void filterWeightedMedian(cv::Mat& disparity, const cv::Mat& left, const WeightedMedianParams& params) {
  requireMap(disparity, "weighted median");
  requireImage(left, disparity.size(), "weighted median");
  if (params.radius <= 0) return;
  const cv::Mat before = disparity.clone();
  const int side = 2 * params.radius + 1, width = disparity.cols;
  const SampleScale scale(before);
  const PaddedSource source(before, scale, left, params.radius);
  const MedianWeight weight = weightOf(params.gamma, left.channels(), side);
  const float min_range = params.min_range_px > 0.0 ? static_cast<float>(params.min_range_px) : -1.0F;
  const WeightedMedianKernels& kernels = FDP_STEREO_SELECT(weightedMedianKernels);
  const auto makeScratch = [&] { return Scratch(side, width); };
  parallelFor(disparity.rows, makeScratch, [&](int y, Scratch& scratch) {
    findEdges(before, y, min_range, scratch.low, scratch.high, scratch.wanted.data());
    auto* d = disparity.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      if (scratch.wanted[x] == 0 || std::isnan(d[x])) continue;
      const auto median =
          kernels.weightedMedian(source.window(y, x), weight, scratch.values.data(), scratch.weights.data());
      if (median != source.centre(y, x)) d[x] = scale.toDisparity(median);
    }
  });
}

}  // namespace fdp_stereo
