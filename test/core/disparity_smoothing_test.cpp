// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/disparity_smoothing.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

TEST(DisparitySmoothing, HandWorkedCase) {
  // One row of one colour, limit 2: around the 1 the neighbours 0 and 1 weigh 3/4 and 1, the 9 does not count.
  cv::Mat disparity = (cv::Mat_<float>(1, 3) << 0.0F, 1.0F, 9.0F);
  smoothDisparity(disparity, cv::Mat(1, 3, CV_8UC1, cv::Scalar(7)), {1, 10.0, 2.0});
  EXPECT_FLOAT_EQ(disparity.at<float>(0, 1), 1.0F / 1.75F);
  EXPECT_FLOAT_EQ(disparity.at<float>(0, 2), 9.0F);
}

TEST(DisparitySmoothing, EqualsTheReference) {
  const DisparitySmoothingParams params{3, 12.0, 2.5};
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const auto& [rows, cols] : {std::pair{1, 33}, {33, 1}, {12, 35}}) {
      const cv::Mat before = reference::randomDisparity(rows, cols, 4.0, 10.0, 0.15, 3);
      const cv::Mat left = reference::texture(rows, cols, type, 4);
      cv::Mat after = before.clone();
      smoothDisparity(after, left, params);
      cv::Mat expected = before.clone();
      for (const bool along_row : {true, false}) {
        const cv::Mat source = expected.clone();
        for (int y = 0; y < rows; ++y) {
          for (int x = 0; x < cols; ++x) {
            expected.at<float>(y, x) = reference::bilateralMean(source, left, x, y, along_row, params.radius,
                                                                params.gamma, params.max_difference_px);
          }
        }
      }
      EXPECT_EQ(reference::differingPixels(after, expected, 2e-3F), 0) << rows << " x " << cols;
    }
  }
}

TEST(DisparitySmoothing, KeepsPlanesStepsAndHoles) {
  cv::Mat before(21, 40, CV_32FC1, cv::Scalar(10.0));
  before.colRange(20, 40).setTo(15.0);
  before.at<float>(10, 5) = kInvalidDisparity;
  cv::Mat after = before.clone();
  smoothDisparity(after, reference::texture(21, 40, CV_8UC3, 1), {4, 15.0, 1.5});
  EXPECT_EQ(reference::differingPixels(after, before, 1e-5F), 0);
}

TEST(DisparitySmoothing, RadiusZeroIsOff) {
  const cv::Mat before = reference::randomDisparity(5, 6, 0.0, 3.0, 0.3, 8);
  cv::Mat after = before.clone();
  smoothDisparity(after, cv::Mat(5, 6, CV_8UC1, cv::Scalar(0)), {0, 15.0, 2.0});
  EXPECT_EQ(reference::differingPixels(after, before), 0);
}

using DisparitySmoothingKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(DisparitySmoothingKernel);

TEST_P(DisparitySmoothingKernel, GivesTheSameBits) {
  const cv::Mat before = reference::randomDisparity(40, 57, 0.0, 6.0, 0.1, 9);
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const cv::Mat left = reference::texture(40, 57, type, 10);
    const auto smoothed = [&] {
      cv::Mat after = before.clone();
      smoothDisparity(after, left, {4, 15.0, 1.5});
      return after;
    };
    EXPECT_EQ(reference::differingPixels(onThisSet(smoothed), onBaseline(smoothed)), 0);
  }
}

}  // namespace
}  // namespace fdp_stereo
