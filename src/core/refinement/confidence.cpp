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

constexpr int kRoughnessSide = 5;              // px, of the window around every pixel
constexpr int kNearCells = 1, kWideCells = 5;  // radii of the windows of cells

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

float contrastMeasure(const cv::Mat& guide) {
  const float contrast = contrastOf(guide);
  return contrast / (contrast + 1.0F);
}

/// As fine as 12 bits allow.
float stepsPerPx(DisparityRange range) {
  float steps = 16.0F;
  while (steps > 1.0F && steps * static_cast<float>(range.count) > kConfidenceLargestSteps) steps *= 0.5F;
  return steps;
}

float bounded(double value, double half) { return static_cast<float>(value / (value + half)); }

/// What windows of cells tell, one entry per cell: far cheaper than windows around every pixel, and as good.
class Cells {
 public:
  Cells(const QualityInput& input, const ConfidenceKernels& kernels)
      : input_(input), lowest_(static_cast<float>(input.search.min)), steps_(stepsPerPx(input.search)) {
    const cv::Size size(cellsOf(input.disparity.cols), cellsOf(input.disparity.rows));
    for (cv::Mat& sum : sums_) sum.create(size, CV_64FC1);
    for (cv::Mat& window : windows_) window.create(size, CV_32FC1);
    parallelFor(size.height, [&](int i) { kernels.fillCells(rowsOf(i), input.disparity.cols); });
    look(kNearCells, kNearSpread, kNearMean);
    lookAtCosts();
    look(kWideCells, kWideSpread, kWideMean);
  }

  /// One entry per cell of the row of cells in which row y is.
  const float* window(int which, int y) const { return windows_[which].ptr<float>(y / kConfidenceCell); }

 private:
  static int cellsOf(int pixels) { return (pixels + kConfidenceCell - 1) / kConfidenceCell; }

  ConfidenceCellRows rowsOf(int i) {
    ConfidenceCellRows rows{};
    for (int k = 0; k < kConfidenceCell; ++k) {
      const int y = std::min(i * kConfidenceCell + k, input_.disparity.rows - 1);
      rows.disparity[k] = input_.disparity.ptr<float>(y);
      rows.margin[k] = input_.margin.ptr<float>(y);
      rows.roughness[k] = input_.roughness.ptr<std::uint8_t>(y);
      rows.grey[k] = input_.guide.ptr<std::uint8_t>(y);
    }
    rows.lowest = lowest_;
    rows.steps = steps_;
    for (int sum = 0; sum < kConfidenceSums; ++sum) rows.sums[sum] = sums_[sum].ptr<double>(i);
    return rows;
  }

  static int pixelsOf(int radius) { return (2 * radius + 1) * (2 * radius + 1) * kConfidenceCell * kConfidenceCell; }

  /// Exact: the sums are whole numbers.
  cv::Mat around(ConfidenceSum which, int radius) const {
    cv::Mat result;
    cv::boxFilter(sums_[which], result, CV_64F, {2 * radius + 1, 2 * radius + 1}, {-1, -1}, false,
                  cv::BORDER_REPLICATE);
    return result;
  }

  /// Where the surface is, and how far it spreads.
  void look(int radius, ConfidenceWindow spread, ConfidenceWindow mean) {
    constexpr double kHalfPx = 0.5;
    const cv::Mat known = around(kKnown, radius), steps = around(kSteps, radius), squares = around(kSquares, radius);
    parallelFor(known.rows, [&](int i) {
      for (int j = 0; j < known.cols; ++j) {
        const double count = known.at<double>(i, j), share = 1.0 / std::max(count, 1.0);
        const double middle = steps.at<double>(i, j) * share;
        const double variance = std::max(squares.at<double>(i, j) * share - middle * middle, 0.0);
        windows_[spread].at<float>(i, j) = bounded(std::sqrt(variance) / steps_, kHalfPx);
        windows_[mean].at<float>(i, j) = static_cast<float>(middle / steps_ + lowest_);
        windows_[kShare].at<float>(i, j) = static_cast<float>(count / pixelsOf(radius));
      }
    });
  }

  void lookAtCosts() {
    constexpr double kHalfRoughness = 0.1 * 63.0, kHalfMargin = 0.05 * kConfidenceMarginSteps, kHalfTexture = 8.0;
    const auto look_at = [&](ConfidenceSum which, double half, ConfidenceWindow window) {
      const cv::Mat sums = around(which, kNearCells);
      for (int i = 0; i < sums.rows; ++i) {
        for (int j = 0; j < sums.cols; ++j) {
          windows_[window].at<float>(i, j) = bounded(sums.at<double>(i, j), half * pixelsOf(kNearCells));
        }
      }
    };
    look_at(kRoughness, kHalfRoughness, kRough);
    look_at(kMargin, kHalfMargin, kMargins);
    look_at(kTexture, kHalfTexture, kTextured);
  }

  const QualityInput& input_;
  float lowest_, steps_;
  cv::Mat sums_[kConfidenceSums];        ///< by cell
  cv::Mat windows_[kConfidenceWindows];  ///< likewise
};

/// Confidence and sigma of rows. One per thread.
class RowJudge {
 public:
  RowJudge(const QualityInput& input, const Cells& cells, const ConfidenceKernels& kernels, float contrast)
      : input_(input),
        cells_(cells),
        kernels_(kernels),
        contrast_(contrast),
        stride_((input.disparity.cols + kConfidenceBlock - 1) / kConfidenceBlock * kConfidenceBlock),
        measures_(static_cast<std::size_t>(stride_) * kConfidenceMeasures) {}

  void judge(int y, const int* roughness, DisparityQuality& quality) {
    const int width = input_.disparity.cols;
    const auto* disparity = input_.disparity.ptr<float>(y);
    ConfidenceRow row{input_.margin.ptr<float>(y),           disparity, nullptr,          roughness, {},
                      static_cast<float>(input_.search.min), contrast_, measures_.data(), stride_};
    if (!input_.disparity_right.empty()) row.right = input_.disparity_right.ptr<float>(y);
    for (int i = 0; i < kConfidenceWindows; ++i) row.windows[i] = cells_.window(i, y);
    kernels_.fillMeasures(row, width);
    kernels_.apply(kConfidenceModel, measures_.data(), stride_, disparity, width, quality.confidence.ptr<float>(y),
                   quality.sigma.ptr<float>(y));
    for (std::size_t i = 0; i < quality.measures.size(); ++i) {
      std::copy_n(measures_.data() + i * stride_, width, quality.measures[i].ptr<float>(y));
    }
  }

 private:
  const QualityInput& input_;
  const Cells& cells_;
  const ConfidenceKernels& kernels_;
  float contrast_;
  int stride_;
  std::vector<float> measures_;
};

}  // namespace

cv::Mat disparityRoughness(const cv::Mat& disparity) {
  const ConfidenceKernels& kernels = FDP_STEREO_SELECT(confidenceKernels);
  cv::Mat result(disparity.size(), CV_8UC1);
  parallelFor(disparity.rows, [&](int y) {
    kernels.roughness(disparity.ptr<float>(y), disparity.ptr<float>(std::max(y - 1, 0)), disparity.cols,
                      result.ptr<std::uint8_t>(y));
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
  const Cells cells(input, kernels);
  cv::Mat roughness;
  cv::boxFilter(input.roughness, roughness, CV_32S, {kRoughnessSide, kRoughnessSide}, {-1, -1}, false,
                cv::BORDER_REPLICATE);
  const float contrast = contrastMeasure(input.guide);
  const auto makeJudge = [&] { return RowJudge(input, cells, kernels, contrast); };
  parallelFor(size.height, makeJudge, [&](int y, RowJudge& judge) { judge.judge(y, roughness.ptr<int>(y), quality); });
  return quality;
}

}  // namespace fdp_stereo
