// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/confidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "parallel.hpp"
#include "refinement/confidence_model.hpp"
#include "simd/confidence_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr int kNear = 2, kWide = 5;         // px, radii of the windows
constexpr int kBandRows = 32;               // whose sums stay in the cache
constexpr float kRoughnessSteps = 63.0F;    // per px
constexpr float kMarginSteps = 8192.0F;     // per cost unit
constexpr float kDisparitySteps = 16.0F;    // per px
constexpr float kLargestDistancePx = 2.0F;  // of the views

constexpr int side(int radius) { return 2 * radius + 1; }
constexpr float area(int radius) { return static_cast<float>(side(radius) * side(radius)); }

/// 0..1, half at `half`: what is large does not count without bound.
float bounded(float value, float half) { return value / (value + half); }

/// Contrast from pixel to pixel, grey levels: the noise, where there is little texture (Immerkaer 1996, with a median).
float contrastOf(const cv::Mat& guide) {
  constexpr int kRowStep = 4;
  constexpr float kMedianToSigma = 1.0F / (0.6745F * 6.0F);
  std::array<int, 8 * 255 + 1> histogram{};
  int count = 0;
  for (int y = 1; y + 1 < guide.rows; y += kRowStep) {
    const auto *above = guide.ptr<std::uint8_t>(y - 1), *row = guide.ptr<std::uint8_t>(y),
               *below = guide.ptr<std::uint8_t>(y + 1);
    const auto curvature = [](const std::uint8_t* line, int x) { return line[x - 1] - 2 * line[x] + line[x + 1]; };
    for (int x = 1; x + 1 < guide.cols; ++x, ++count) {
      ++histogram[std::abs(curvature(above, x) - 2 * curvature(row, x) + curvature(below, x))];
    }
  }
  int median = 0;
  for (int below = histogram[0]; 2 * below < count; below += histogram[++median]) {
  }
  return static_cast<float>(median) * kMedianToSigma;
}

/// Whole numbers, so that the sums over windows are exact in any order.
struct Maps {
  cv::Mat margin;     // CV_16UC1
  cv::Mat texture;    // CV_8UC1, steps across two pixels
  cv::Mat known;      // CV_8UC1, 0 or 1
  cv::Mat disparity;  // CV_16UC1 above the smallest of the range, 0 where none
  cv::Mat square;     // CV_32FC1

  explicit Maps(const QualityInput& input) {
    const cv::Size size = input.disparity.size();
    margin.create(size, CV_16UC1);
    texture.create(size, CV_8UC1);
    known.create(size, CV_8UC1);
    disparity.create(size, CV_16UC1);
    square.create(size, CV_32FC1);
    parallelFor(size.height, [&](int y) { fillRow(input, y); });
  }

 private:
  void fillRow(const QualityInput& input, int y) {
    constexpr float kLargest = 65535.0F;
    const int width = margin.cols;
    const auto *from_margin = input.margin.ptr<float>(y), *from_disparity = input.disparity.ptr<float>(y);
    const auto* grey = input.guide.ptr<std::uint8_t>(y);
    auto *to_margin = margin.ptr<std::uint16_t>(y), *to_disparity = disparity.ptr<std::uint16_t>(y);
    auto *to_texture = texture.ptr<std::uint8_t>(y), *to_known = known.ptr<std::uint8_t>(y);
    auto* to_square = square.ptr<float>(y);
    const auto lowest = static_cast<float>(input.search.min);
    for (int x = 0; x < width; ++x) {
      const float d = from_disparity[x];
      const bool is_known = d == d;
      const float steps = is_known ? (d - lowest) * kDisparitySteps + 0.5F : 0.0F;
      const auto whole = static_cast<int>(std::min(std::max(steps, 0.0F), kLargest));
      to_known[x] = is_known ? 1 : 0;
      to_disparity[x] = static_cast<std::uint16_t>(whole);
      to_square[x] = static_cast<float>(whole) * static_cast<float>(whole);
      to_margin[x] = static_cast<std::uint16_t>(static_cast<int>(std::min(from_margin[x] * kMarginSteps, kLargest)));
    }
    to_texture[0] = to_texture[width - 1] = 0;
    for (int x = 1; x + 1 < width; ++x) {
      to_texture[x] = static_cast<std::uint8_t>(std::abs(grey[x + 1] - grey[x - 1]));
    }
  }
};

/// Sums over windows around the pixels of a band of rows.
struct Sums {
  cv::Mat roughness_near, roughness_wide, margin, texture, known, disparity, square;

  void compute(const cv::Mat& roughness, const Maps& maps, const cv::Range& rows) {
    const auto sum = [&](const cv::Mat& map, int depth, int radius, cv::Mat& sums) {
      cv::boxFilter(map.rowRange(rows), sums, depth, {side(radius), side(radius)}, {-1, -1}, false,
                    cv::BORDER_REPLICATE);
    };
    sum(roughness, CV_32S, kNear, roughness_near);
    sum(roughness, CV_32S, kWide, roughness_wide);
    sum(maps.margin, CV_32S, kNear, margin);
    sum(maps.texture, CV_32S, kNear, texture);
    sum(maps.known, CV_32S, kWide, known);
    sum(maps.disparity, CV_32S, kWide, disparity);
    sum(maps.square, CV_64F, kWide, square);
  }
};

/// Measures of one row; measure i of pixel x is at [i * stride + x]. The model was fitted to them in this form.
class MeasureRow {
 public:
  explicit MeasureRow(int width)
      : stride_((width + kConfidenceBlock - 1) / kConfidenceBlock * kConfidenceBlock),
        values_(static_cast<std::size_t>(stride_) * kConfidenceMeasures) {}

  int stride() const { return stride_; }
  const float* data() const { return values_.data(); }
  const float* of(int measure) const { return values_.data() + static_cast<std::ptrdiff_t>(measure) * stride_; }

  void fill(const QualityInput& input, const Sums& sums, float contrast, int y, int band_y) {
    fillCosts(input, sums, contrast, y, band_y);
    fillPlaces(input, y);
    fillSurface(input, sums, y, band_y);
  }

 private:
  float* at(int measure) { return values_.data() + static_cast<std::ptrdiff_t>(measure) * stride_; }

  void fillCosts(const QualityInput& input, const Sums& sums, float contrast, int y, int band_y) {
    constexpr float kHalfMargin = 0.05F, kHalfRoughnessPx = 0.1F, kHalfTexture = 8.0F, kHalfContrast = 1.0F;
    const auto* margin = input.margin.ptr<float>(y);
    const auto *rough_near = sums.roughness_near.ptr<int>(band_y), *rough_wide = sums.roughness_wide.ptr<int>(band_y);
    const auto *margins = sums.margin.ptr<int>(band_y), *texture = sums.texture.ptr<int>(band_y);
    float *to_margin = at(0), *to_rough_near = at(2), *to_rough_wide = at(3), *to_margins = at(4), *to_texture = at(5),
          *to_contrast = at(6);
    const float bounded_contrast = bounded(contrast, kHalfContrast);
    for (int x = 0; x < input.margin.cols; ++x) {
      to_margin[x] = bounded(margin[x], kHalfMargin);
      to_rough_near[x] = bounded(static_cast<float>(rough_near[x]), kHalfRoughnessPx * kRoughnessSteps * area(kNear));
      to_rough_wide[x] = bounded(static_cast<float>(rough_wide[x]), kHalfRoughnessPx * kRoughnessSteps * area(kWide));
      to_margins[x] = bounded(static_cast<float>(margins[x]), kHalfMargin * kMarginSteps * area(kNear));
      to_texture[x] = bounded(static_cast<float>(texture[x]), kHalfTexture * area(kNear));
      to_contrast[x] = bounded_contrast;
    }
  }

  void fillPlaces(const QualityInput& input, int y) {
    constexpr float kHalfDisparityPx = 16.0F, kFarPx = 100.0F;
    const auto* disparity = input.disparity.ptr<float>(y);
    const auto* right = input.disparity_right.empty() ? nullptr : input.disparity_right.ptr<float>(y);
    float *to_distance = at(1), *to_border = at(7), *to_disparity = at(8);
    for (int x = 0; x < input.disparity.cols; ++x) {
      const float d = disparity[x] == disparity[x] ? disparity[x] : 0.0F;
      const float match =
          std::min(std::max(static_cast<float>(x) - d, 0.0F), static_cast<float>(input.disparity.cols - 1));
      const float distance = right == nullptr ? 0.0F : std::abs(d - right[static_cast<int>(match + 0.5F)]);
      to_distance[x] = (distance < kLargestDistancePx ? distance : kLargestDistancePx) / kLargestDistancePx;
      to_border[x] = std::min(match, kFarPx) / kFarPx;
      to_disparity[x] = bounded(std::max(d, 0.0F), kHalfDisparityPx);
    }
  }

  void fillSurface(const QualityInput& input, const Sums& sums, int y, int band_y) {
    constexpr float kHalfPx = 0.5F;
    const auto* disparity = input.disparity.ptr<float>(y);
    const auto *known = sums.known.ptr<int>(band_y), *sum = sums.disparity.ptr<int>(band_y);
    const auto* squares = sums.square.ptr<double>(band_y);
    float *to_spread = at(9), *to_offset = at(10);
    const auto lowest = static_cast<float>(input.search.min);
    for (int x = 0; x < input.disparity.cols; ++x) {
      const float d = disparity[x] == disparity[x] ? disparity[x] - lowest : 0.0F;
      const double count = std::max(known[x], 1), mean = sum[x] / count;
      const auto variance = static_cast<float>(std::max(squares[x] / count - mean * mean, 0.0));
      const float offset = d - static_cast<float>(mean) * (1.0F / kDisparitySteps);
      to_spread[x] = bounded(std::sqrt(variance), kHalfPx * kDisparitySteps);
      to_offset[x] = offset / (std::abs(offset) + kHalfPx);
    }
  }

  int stride_;
  std::vector<float> values_;
};

/// A step between neighbours: none to none is none, to a disparity the largest.
float stepBetween(float a, float b) {
  constexpr float kLargestStepPx = 2.0F;
  const float step = std::abs(a - b);
  if (step < kLargestStepPx) return step;
  return a != a && b != b ? 0.0F : kLargestStepPx;
}

}  // namespace

cv::Mat disparityRoughness(const cv::Mat& disparity) {
  cv::Mat result(disparity.size(), CV_8UC1);
  parallelFor(disparity.rows, [&](int y) {
    const auto *row = disparity.ptr<float>(y), *above = disparity.ptr<float>(std::max(y - 1, 0));
    auto* to = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      const float steps = stepBetween(row[x], row[std::max(x - 1, 0)]) + stepBetween(row[x], above[x]);
      to[x] = static_cast<std::uint8_t>(static_cast<int>(steps * kRoughnessSteps));
    }
  });
  return result;
}

DisparityQuality judgeDisparity(const QualityInput& input, bool keep_measures) {
  const cv::Size size = input.disparity.size();
  DisparityQuality quality{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1), {}};
  if (keep_measures) {
    for (int i = 0; i < kConfidenceMeasures; ++i) quality.measures.emplace_back(size, CV_32FC1);
  }
  const ConfidenceKernels& kernels = FDP_STEREO_SELECT(confidenceKernels);
  const Maps maps(input);
  const float contrast = contrastOf(input.guide);
  struct Scratch {
    Sums sums;
    MeasureRow measures;
    std::vector<float> confidence, sigma;
  };
  const auto makeScratch = [&] {
    MeasureRow row(size.width);
    const auto width = static_cast<std::size_t>(row.stride());
    return Scratch{{}, std::move(row), std::vector<float>(width), std::vector<float>(width)};
  };
  const auto judgeBand = [&](int band, Scratch& scratch) {
    const cv::Range rows(band * kBandRows, std::min((band + 1) * kBandRows, size.height));
    scratch.sums.compute(input.roughness, maps, rows);
    for (int y = rows.start; y < rows.end; ++y) {
      MeasureRow& measures = scratch.measures;
      measures.fill(input, scratch.sums, contrast, y, y - rows.start);
      kernels.apply(kConfidenceModel, measures.data(), measures.stride(), measures.stride(), scratch.confidence.data(),
                    scratch.sigma.data());
      const auto* disparity = input.disparity.ptr<float>(y);
      auto *confidence = quality.confidence.ptr<float>(y), *sigma = quality.sigma.ptr<float>(y);
      for (int x = 0; x < size.width; ++x) {
        const bool known = disparity[x] == disparity[x];
        confidence[x] = known ? scratch.confidence[x] : 0.0F;
        sigma[x] = known ? scratch.sigma[x] : kInvalidDisparity;
      }
      for (std::size_t i = 0; i < quality.measures.size(); ++i) {
        std::copy_n(measures.of(static_cast<int>(i)), size.width, quality.measures[i].ptr<float>(y));
      }
    }
  };
  parallelFor((size.height + kBandRows - 1) / kBandRows, makeScratch, judgeBand, 1);
  return quality;
}

}  // namespace fdp_stereo
