// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/confidence.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/pipeline.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr int kRows = 120, kCols = 240;

/// A floor seen from above its texture: the disparity grows from row to row, through all fractions of a pixel.
struct Floor {
  cv::Mat left, right, truth;
};

Floor floorPair() {
  Floor floor;
  const cv::Mat right = reference::texture(kRows, kCols + 40, CV_8UC1, 5);
  cv::Mat smooth;
  cv::GaussianBlur(right, smooth, {3, 3}, 0.8);
  floor.right = smooth(cv::Rect(20, 0, kCols, kRows)).clone();
  cv::Mat from_x(kRows, kCols, CV_32FC1), from_y(kRows, kCols, CV_32FC1);
  floor.truth.create(kRows, kCols, CV_32FC1);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kCols; ++x) {
      floor.truth.at<float>(y, x) = 4.0F + 0.05F * static_cast<float>(y);
      from_x.at<float>(y, x) = static_cast<float>(x + 20) - floor.truth.at<float>(y, x);
      from_y.at<float>(y, x) = static_cast<float>(y);
    }
  }
  cv::remap(smooth, floor.left, from_x, from_y, cv::INTER_CUBIC);
  return floor;
}

PipelineParams params(int count) {
  PipelineParams result;
  result.search.count = count;
  return result;
}

double meanOver(const cv::Mat& confidence, const cv::Mat& truth, float lowest, float highest) {
  double sum = 0.0;
  int count = 0;
  for (int y = 5; y < kRows - 5; ++y) {
    const float away = std::abs(truth.at<float>(y, 0) - std::round(truth.at<float>(y, 0)));
    if (away < lowest || away > highest) continue;
    for (int x = 40; x < kCols - 5; ++x, ++count) sum += confidence.at<float>(y, x);
  }
  return sum / count;
}

TEST(Confidence, IsHighOnAFloorAtEveryFraction) {
  const Floor floor = floorPair();
  const PipelineResult result = Pipeline(params(32)).run(floor.left, floor.right);
  const double whole = meanOver(result.confidence, floor.truth, 0.0F, 0.1F);
  const double half = meanOver(result.confidence, floor.truth, 0.4F, 0.5F);
  EXPECT_GT(whole, 0.9);
  EXPECT_NEAR(whole, half, 0.05);
}

TEST(Confidence, SigmaBoundsTheErrorsOfAFloor) {
  const Floor floor = floorPair();
  const PipelineResult result = Pipeline(params(32)).run(floor.left, floor.right);
  const cv::Mat error = cv::abs(result.disparity - floor.truth), sure = result.confidence > 0.8F;
  const int all = cv::countNonZero(sure);
  EXPECT_GT(all, kRows * kCols / 2);
  EXPECT_GE(cv::countNonZero((error <= result.sigma) & sure), all * 60 / 100);
  EXPECT_GE(cv::countNonZero((error <= 3.0 * result.sigma) & sure), all * 95 / 100);
}

TEST(Confidence, SigmaIsKnownWhereThereIsConfidence) {
  const reference::RenderedPair pair = reference::renderPair(kRows, kCols, 6, 15, 5);
  for (const double scale : {1.0, 0.5}) {
    for (const bool filled : {false, true}) {
      PipelineParams own = params(32);
      own.scale = scale;
      own.hole_filling.enabled = filled;
      const PipelineResult result = Pipeline(own).run(pair.left, pair.right);
      ASSERT_EQ(result.sigma.size(), pair.left.size());
      for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < kCols; ++x) {
          const float confidence = result.confidence.at<float>(y, x), sigma = result.sigma.at<float>(y, x);
          ASSERT_EQ(std::isnan(sigma), confidence == 0.0F) << x << ", " << y;
          ASSERT_FALSE(sigma <= 0.0F);
        }
      }
    }
  }
}

TEST(Confidence, IsLeftOutWhereNobodyWantsIt) {
  const reference::RenderedPair pair = reference::renderPair(60, 90, 4, 9, 2);
  Pipeline pipeline(params(16));
  const PipelineResult with = pipeline.run(pair.left, pair.right);
  pipeline.setQuality(Pipeline::Quality::kNone);
  const PipelineResult without = pipeline.run(pair.left, pair.right);
  EXPECT_TRUE(without.confidence.empty() && without.sigma.empty());
  EXPECT_TRUE(reference::sameBits(with.disparity, without.disparity));
}

TEST(Confidence, RoughnessIsTheStepsInWholeNumbers) {
  const float none = kInvalidDisparity;
  const cv::Mat disparity = (cv::Mat_<float>(2, 4) << 1.0F, 1.5F, 9.0F, none, 1.0F, 1.5F, none, none);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(2, 4) << 0, 31, 126, 126, 0, 31, 252, 0);
  EXPECT_EQ(cv::norm(disparityRoughness(disparity), expected, cv::NORM_INF), 0.0);
}

class ConfidenceKernels : public reference::EveryInstructionSet {};

TEST_P(ConfidenceKernels, SameBitsAndMeasuresBetweenMinus1And1) {
  for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 37}, {40, 3}, {70, 65}}) {
    const cv::Mat disparity = reference::randomDisparity(rows, cols, 4.0, 10.0, 0.15, 3);
    const cv::Mat right = reference::randomDisparity(rows, cols, 4.0, 10.0, 0.15, 4);
    const cv::Mat guide = reference::texture(rows, cols, CV_8UC1, 4), roughness = disparityRoughness(disparity);
    const cv::Mat margin = cv::abs(reference::randomDisparity(rows, cols, 0.0, 1.0, 0.0, 5));
    const QualityInput input{roughness, margin, disparity, right, guide, {0, 16}};
    const auto judge = [&] { return judgeDisparity(input, true); };
    const DisparityQuality actual = onThisSet(judge), expected = onBaseline(judge);
    EXPECT_TRUE(reference::sameBits(actual.confidence, expected.confidence)) << rows << " x " << cols;
    EXPECT_TRUE(reference::sameBits(actual.sigma, expected.sigma)) << rows << " x " << cols;
    for (const cv::Mat& measure : actual.measures) EXPECT_LE(cv::norm(measure, cv::NORM_INF), 1.0);
  }
}

FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(ConfidenceKernels);

}  // namespace
}  // namespace fdp_stereo
