// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/left_right_check.hpp"

#include <algorithm>
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
  checkLeftRight(left, right, {true, 1.0, false});
  const cv::Mat expected = (cv::Mat_<float>(1, 5) << kNone, kNone, kNone, 2.0F, kNone);
  EXPECT_EQ(reference::differingPixels(left, expected), 0);
}

TEST(LeftRightCheck, TheLimitItselfPasses) {
  const auto kept = [](double limit) {
    cv::Mat left = (cv::Mat_<float>(1, 4) << kNone, kNone, kNone, 2.0F);
    checkLeftRight(left, (cv::Mat_<float>(1, 4) << kNone, 3.0F, kNone, kNone), {true, limit, false});
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
    checkLeftRight(after, right, {true, 2.5, false});
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < cols; ++x) {
        const float d = before.at<float>(y, x);
        const float match = static_cast<float>(x) - d;
        const bool inside = match >= 0.0F && match <= static_cast<float>(cols - 1);
        const auto answers = [&](float u) {
          return inside && std::fabs(right.at<float>(y, static_cast<int>(u)) - d) <= 2.5F;
        };
        const bool agrees = answers(std::floor(match)) || answers(std::ceil(match));
        ASSERT_TRUE(reference::bothNanOrNear(after.at<float>(y, x), agrees ? d : kNone, 0.0F)) << x << ", " << y;
      }
    }
  }
}

TEST(LeftRightCheck, AConsistentPairLosesOnlyTheBorder) {
  cv::Mat left(6, 20, CV_32FC1, cv::Scalar(4.25));
  checkLeftRight(left, cv::Mat(6, 20, CV_32FC1, cv::Scalar(4.0)), {true, 1.0, false});
  EXPECT_EQ(cv::countNonZero(left == left), 6 * 15);
  EXPECT_TRUE(std::isnan(left.at<float>(2, 3)));
}

TEST(LeftRightCheck, EitherPixelBesideAFractionAnswers) {
  for (const bool first : {true, false}) {
    cv::Mat left = (cv::Mat_<float>(1, 4) << kNone, kNone, kNone, 1.5F);
    const cv::Mat right = (cv::Mat_<float>(1, 4) << kNone, first ? 1.5F : 9.0F, first ? 9.0F : 1.5F, kNone);
    checkLeftRight(left, right, {true, 1.0, false});
    EXPECT_EQ(left.at<float>(0, 3), 1.5F) << first;
  }
}

/// Own count of the votes: agreeing pixels along the rows of the pixels of the column that are alike.
bool outvoted(const cv::Mat& left, const cv::Mat& agreeing, int x, int y) {
  const auto alike = [&](float a, float b) { return std::fabs(a - b) <= 1.0F; };
  int votes = 0, pixels = 0;
  for (int v = std::max(0, y - 3); v <= std::min(left.rows - 1, y + 3); ++v) {
    for (int u = std::max(0, x - 3); u <= std::min(left.cols - 1, x + 3); ++u) {
      const float between = left.at<float>(v, x);
      ++pixels;
      votes += alike(left.at<float>(y, x), between) && alike(between, agreeing.at<float>(v, u)) ? 1 : 0;
    }
  }
  return votes < 0.42 * pixels;
}

TEST(LeftRightCheck, EqualsTheReferenceWithVotes) {
  for (const auto& [rows, cols] : {std::pair{1, 40}, {13, 29}, {29, 1}, {2, 3}}) {
    const cv::Mat before = reference::randomDisparity(rows, cols, 0.0, 3.0, 0.1, 3);
    const cv::Mat right = reference::randomDisparity(rows, cols, 0.0, 3.0, 0.1, 4);
    cv::Mat agreeing = before.clone(), after = before.clone();
    checkLeftRight(agreeing, right, {true, 1.0, false});
    checkLeftRight(after, right, {true, 1.0, true});
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < cols; ++x) {
        const float expected = outvoted(before, agreeing, x, y) ? kNone : before.at<float>(y, x);
        ASSERT_TRUE(reference::bothNanOrNear(after.at<float>(y, x), expected, 0.0F)) << x << ", " << y;
      }
    }
  }
}

TEST(LeftRightCheck, NeighboursKeepAPixelOrDropIt) {
  cv::Mat left(9, 30, CV_32FC1, cv::Scalar(4.0));
  cv::Mat right(9, 30, CV_32FC1, cv::Scalar(4.0));
  right.at<float>(4, 16) = 9.0F;  // left x = 20 stands alone in failing
  left.at<float>(4, 10) = 8.0F;   // and x = 10 in what it says, though the right pixel agrees
  right.at<float>(4, 2) = 8.0F;
  checkLeftRight(left, right, {true, 1.0, true});
  EXPECT_EQ(left.at<float>(4, 20), 4.0F);
  EXPECT_TRUE(std::isnan(left.at<float>(4, 10)));
}

}  // namespace
}  // namespace fdp_stereo
