// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/left_right_check.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(LeftRightCheck, HandWorkedCase) {
  // Left x = 3 with d = 2 points at right x = 1, whose 2.5 differs by 0.5; x = 4 with 1 points at x = 3, off by 4; x =
  // 0 with 1 points outside; x = 2 with 2 points at x = 0, which knows nothing.
  cv::Mat left = (cv::Mat_<float>(1, 5) << 1.0F, kNone, 2.0F, 2.0F, 1.0F);
  const cv::Mat right = (cv::Mat_<float>(1, 5) << kNone, 2.5F, 0.0F, 5.0F, 0.0F);
  checkLeftRight(left, right, {true, 1.0});
  const cv::Mat expected = (cv::Mat_<float>(1, 5) << kNone, kNone, kNone, 2.0F, kNone);
  EXPECT_EQ(reference::differingPixels(left, expected), 0);
}

TEST(LeftRightCheck, TheLimitItselfPasses) {
  const auto kept = [](double limit) {
    cv::Mat left = (cv::Mat_<float>(1, 4) << kNone, kNone, kNone, 2.0F);
    checkLeftRight(left, (cv::Mat_<float>(1, 4) << kNone, 3.0F, kNone, kNone), {true, limit});
    return !std::isnan(left.at<float>(0, 3));
  };
  EXPECT_TRUE(kept(1.0));
  EXPECT_FALSE(kept(0.99));
}

TEST(LeftRightCheck, KeepsExactlyWhatAgrees) {
  for (const auto& [rows, cols] : {std::pair{1, 40}, {13, 29}, {7, 1}}) {
    const cv::Mat before = reference::randomDisparity(rows, cols, -6.0, 12.0, 0.1, 3);
    const cv::Mat right = reference::randomDisparity(rows, cols, -6.0, 12.0, 0.1, 4);
    cv::Mat after = before.clone();
    checkLeftRight(after, right, {true, 2.5});
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < cols; ++x) {
        const float d = before.at<float>(y, x);
        const int match = std::isnan(d) ? -1 : static_cast<int>(std::lround(static_cast<float>(x) - d));
        const bool agrees = match >= 0 && match < cols && std::fabs(right.at<float>(y, match) - d) <= 2.5F;
        ASSERT_TRUE(reference::bothNanOrNear(after.at<float>(y, x), agrees ? d : kNone, 0.0F)) << x << ", " << y;
      }
    }
  }
}

TEST(LeftRightCheck, AConsistentPairLosesOnlyTheBorder) {
  cv::Mat left(6, 20, CV_32FC1, cv::Scalar(4.25));
  checkLeftRight(left, cv::Mat(6, 20, CV_32FC1, cv::Scalar(4.0)), {true, 1.0});
  EXPECT_EQ(cv::countNonZero(left == left), 6 * 16);
  EXPECT_TRUE(std::isnan(left.at<float>(2, 3)));
}

}  // namespace
}  // namespace fdp_stereo
