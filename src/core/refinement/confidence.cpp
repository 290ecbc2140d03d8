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

constexpr int kNear = 2, kWide = 5;  // px, radii of the windows
constexpr int kBandRows = 48;        // whose maps and sums stay in the cache

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

/// Confidence and sigma of bands of rows. One per thread.
class BandJudge {
 public:
  BandJudge(const QualityInput& input, float contrast)
      : input_(input),
        kernels_(FDP_STEREO_SELECT(confidenceKernels)),
        contrast_(contrast),
        steps_(stepsPerPx(input.search)),
        stride_((input.disparity.cols + kConfidenceBlock - 1) / kConfidenceBlock * kConfidenceBlock),
        measures_(static_cast<std::size_t>(stride_) * kConfidenceMeasures) {}

  void judge(const cv::Range& rows, DisparityQuality& quality) {
    fillMaps(rows);
    sumMaps(rows);
    for (int y = rows.start; y < rows.end; ++y) {
      fillMeasures(y, y - rows.start);
      writeRow(y, quality);
    }
  }

 private:
  /// Of the rows and of those that the windows reach beside them, the outermost ones of the image repeated.
  void fillMaps(const cv::Range& rows) {
    const cv::Size size(input_.disparity.cols, rows.size() + 2 * kWide);
    margin_.create(size, CV_16UC1);
    texture_.create(size, CV_8UC1);
    known_.create(size, CV_8UC1);
    disparity_.create(size, CV_16UC1);
    square_.create(size, CV_32SC1);
    for (int i = 0; i < size.height; ++i) {
      const int y = std::min(std::max(rows.start + i - kWide, 0), input_.disparity.rows - 1);
      kernels_.fillMaps(
          {input_.margin.ptr<float>(y), input_.disparity.ptr<float>(y), input_.guide.ptr<std::uint8_t>(y),
           static_cast<float>(input_.search.min), steps_, margin_.ptr<std::uint16_t>(i), texture_.ptr<std::uint8_t>(i),
           known_.ptr<std::uint8_t>(i), disparity_.ptr<std::uint16_t>(i), square_.ptr<std::int32_t>(i)},
          size.width);
    }
  }

  void sumMaps(const cv::Range& rows) {
    const cv::Range own(kWide, kWide + rows.size());
    const auto sum = [](const cv::Mat& map, int radius, cv::Mat& sums) {
      const int side = 2 * radius + 1;
      cv::boxFilter(map, sums, CV_32S, {side, side}, {-1, -1}, false, cv::BORDER_REPLICATE);
    };
    sum(input_.roughness.rowRange(rows), kNear, roughness_near_);
    sum(input_.roughness.rowRange(rows), kWide, roughness_wide_);
    sum(margin_.rowRange(own), kNear, margins_);
    sum(texture_.rowRange(own), kNear, textures_);
    sum(known_.rowRange(own), kWide, knowns_);
    sum(disparity_.rowRange(own), kWide, disparities_);
    sum(square_.rowRange(own), kWide, squares_);
  }

  void fillMeasures(int y, int i) {
    kernels_.fillMeasures({input_.margin.ptr<float>(y), input_.disparity.ptr<float>(y),
                           input_.disparity_right.empty() ? nullptr : input_.disparity_right.ptr<float>(y),
                           roughness_near_.ptr<int>(i), roughness_wide_.ptr<int>(i), margins_.ptr<int>(i),
                           textures_.ptr<int>(i), knowns_.ptr<int>(i), disparities_.ptr<int>(i), squares_.ptr<int>(i),
                           static_cast<float>(input_.search.min), steps_, contrast_, measures_.data(), stride_},
                          input_.disparity.cols);
  }

  void writeRow(int y, DisparityQuality& quality) const {
    const int width = input_.disparity.cols;
    kernels_.apply(kConfidenceModel, measures_.data(), stride_, input_.disparity.ptr<float>(y), width,
                   quality.confidence.ptr<float>(y), quality.sigma.ptr<float>(y));
    for (std::size_t i = 0; i < quality.measures.size(); ++i) {
      std::copy_n(measures_.data() + i * stride_, width, quality.measures[i].ptr<float>(y));
    }
  }

  const QualityInput& input_;
  const ConfidenceKernels& kernels_;
  float contrast_, steps_;
  int stride_;
  cv::Mat margin_, texture_, known_, disparity_, square_;
  cv::Mat roughness_near_, roughness_wide_, margins_, textures_, knowns_, disparities_, squares_;
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
  const float contrast = contrastMeasure(input.guide);
  const auto makeJudge = [&] { return BandJudge(input, contrast); };
  const auto judgeBand = [&](int band, BandJudge& judge) {
    judge.judge({band * kBandRows, std::min((band + 1) * kBandRows, size.height)}, quality);
  };
  parallelFor((size.height + kBandRows - 1) / kBandRows, makeJudge, judgeBand, 1);
  return quality;
}

}  // namespace fdp_stereo
