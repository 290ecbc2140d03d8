// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/weighted_median.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr float kTolerance = 1.0F / 64.0F;  // px, of the samples

WeightedMedianParams paramsOf(int radius, double gamma) {
  WeightedMedianParams params;
  params.radius = radius;
  params.gamma = gamma;
  params.min_range_px = 0.0;
  return params;
}

TEST(WeightedMedian, HandWorkedPlainMedian) {
  cv::Mat disparity = (cv::Mat_<float>(3, 3) << 1, 2, 3, 4, 90, 5, 6, 7, 8);
  filterWeightedMedian(disparity, cv::Mat(3, 3, CV_8UC1, cv::Scalar(0)), paramsOf(1, 0.0));
  EXPECT_EQ(disparity.at<float>(1, 1), 5.0F);
}

TEST(WeightedMedian, HandWorkedWeights) {
  // The centre of the row looks like its left neighbour (weight 1 each), not like its right ones (weight e^-10).
  cv::Mat disparity = (cv::Mat_<float>(1, 5) << 3.0F, 3.0F, 8.0F, 9.0F, 9.0F);
  const cv::Mat left = (cv::Mat_<std::uint8_t>(1, 5) << 50, 50, 50, 150, 150);
  filterWeightedMedian(disparity, left, paramsOf(2, 10.0));
  EXPECT_EQ(disparity.at<float>(0, 2), 3.0F);
}

TEST(WeightedMedian, SplitsTheWeightInHalves) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const double gamma : {0.0, 10.0, 60.0}) {
      for (const int radius : {1, 2, 4}) {
        for (const auto& [rows, cols] : {std::pair{1, 21}, {13, 1}, {14, 27}}) {
          const double window = (2.0 * radius + 1.0) * (2.0 * radius + 1.0);
          const double rounding = window * window / 65535.0;  // half a step of each weight, in both halves
          const cv::Mat before = reference::randomDisparity(rows, cols, 0.0, 30.0, 0.2, 5);
          const cv::Mat left = reference::texture(rows, cols, type, 6);
          cv::Mat after = before.clone();
          filterWeightedMedian(after, left, paramsOf(radius, gamma));
          for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < cols; ++x) {
              const float value = after.at<float>(y, x);
              ASSERT_EQ(std::isnan(value), std::isnan(before.at<float>(y, x))) << "empty pixels stay, no other comes";
              if (std::isnan(value)) continue;
              const auto balance = reference::medianBalance(before, left, x, y, radius, gamma, value, kTolerance);
              ASSERT_TRUE(balance.is_a_sample) << x << ", " << y;
              ASSERT_LE(balance.twice_below, balance.all * (1.0 + 3e-3) + rounding) << x << ", " << y;
              ASSERT_LE(balance.twice_above, balance.all * (1.0 + 3e-3) + rounding) << x << ", " << y;
            }
          }
        }
      }
    }
  }
}

TEST(WeightedMedian, LeavesFlatPlacesAloneWhereAsked) {
  // A slant of 0.1 px per column with one outlier: only around it do 3 x 3 disparities differ by more than 1 px.
  cv::Mat before(9, 15, CV_32FC1);
  for (int x = 0; x < 15; ++x) before.col(x).setTo(0.1 * x);
  before.at<float>(4, 7) = 20.0F;
  WeightedMedianParams params = paramsOf(2, 0.0);
  params.min_range_px = 1.0;
  cv::Mat after = before.clone();
  filterWeightedMedian(after, cv::Mat(9, 15, CV_8UC1, cv::Scalar(0)), params);
  EXPECT_LT(after.at<float>(4, 7), 2.0F);
  after.at<float>(4, 7) = before.at<float>(4, 7);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 15; ++x) {
      if (std::abs(x - 7) <= 1 && std::abs(y - 4) <= 1) continue;
      EXPECT_EQ(after.at<float>(y, x), before.at<float>(y, x)) << x << ", " << y;
    }
  }
}

TEST(WeightedMedian, RadiusZeroIsOff) {
  const cv::Mat before = reference::randomDisparity(5, 6, 0.0, 30.0, 0.3, 8);
  cv::Mat after = before.clone();
  filterWeightedMedian(after, cv::Mat(5, 6, CV_8UC1, cv::Scalar(0)), paramsOf(0, 10.0));
  EXPECT_EQ(reference::differingPixels(after, before), 0);
}

using WeightedMedianKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(WeightedMedianKernel);

TEST_P(WeightedMedianKernel, GivesTheSameBits) {
  const cv::Mat before = reference::randomDisparity(40, 57, 0.0, 30.0, 0.1, 9);
  const cv::Mat left = reference::texture(40, 57, CV_8UC3, 10);
  const auto filtered = [&] {
    cv::Mat after = before.clone();
    filterWeightedMedian(after, left, paramsOf(3, 30.0));
    return after;
  };
  EXPECT_EQ(reference::differingPixels(onThisSet(filtered), onBaseline(filtered)), 0);
}

}  // namespace
}  // namespace fdp_stereo
