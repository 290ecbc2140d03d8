// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/point_selection.hpp"

#include <gtest/gtest.h>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace {

/// A near surface left of a far one; `between` columns lead from one to the other.
cv::Mat edge(int between) {
  cv::Mat map(20, 40, CV_32FC1, cv::Scalar(10.0F));
  for (int i = 0; i < between; ++i) map.col(20 + i).setTo(30.0 - 20.0 * (i + 1) / (between + 1));
  map.colRange(0, 20).setTo(30.0F);
  return map;
}

TEST(FlyingPixels, ASharpEdgeHasNone) { EXPECT_EQ(cv::countNonZero(flyingPixels(edge(0))), 0); }

TEST(FlyingPixels, ColumnsBetweenTwoSurfaces) {
  for (const int between : {1, 2, 3, 4}) {
    const cv::Mat flying = flyingPixels(edge(between));
    EXPECT_EQ(cv::countNonZero(flying.colRange(20, 20 + between)), 20 * between) << between;
    EXPECT_EQ(cv::countNonZero(flying.colRange(0, 18)), 0);
    EXPECT_EQ(cv::countNonZero(flying.colRange(22 + between, 40)), 0);
  }
}

TEST(FlyingPixels, RowsBetweenTwoSurfaces) {
  const cv::Mat flying = flyingPixels(edge(2).t());
  EXPECT_EQ(cv::countNonZero(flying.rowRange(20, 22)), 40);
}

TEST(FlyingPixels, AFloorThatIsSeenFlatStays) {
  cv::Mat map(40, 40, CV_32FC1);
  for (int y = 0; y < 40; ++y) map.row(y).setTo(5.0 + 0.3 * y);
  EXPECT_EQ(cv::countNonZero(flyingPixels(map)), 0);
}

TEST(FlyingPixels, ALonePixelAndAnEmptyMap) {
  cv::Mat map(9, 9, CV_32FC1, cv::Scalar(kInvalidDisparity));
  EXPECT_EQ(cv::countNonZero(flyingPixels(map)), 0);
  map.at<float>(4, 4) = 7.0F;
  EXPECT_EQ(cv::countNonZero(flyingPixels(map)), 1);
  EXPECT_EQ(cv::countNonZero(flyingPixels(cv::Mat(1, 1, CV_32FC1, cv::Scalar(3.0F)))), 1);
}

TEST(BestPixels, TheMostConfidentOfEachSquare) {
  cv::Mat usable(5, 7, CV_8UC1, cv::Scalar(255));
  cv::Mat confidence(5, 7, CV_32FC1, cv::Scalar(0.5F));
  confidence.at<float>(1, 2) = 0.9F;
  confidence.at<float>(4, 6) = 0.8F;
  usable(cv::Rect(3, 0, 3, 3)).setTo(0);
  const cv::Mat best = bestPixels(usable, confidence, 3);
  ASSERT_EQ(best.size(), cv::Size(3, 2));
  EXPECT_EQ(best.at<cv::Vec2i>(0, 0), cv::Vec2i(2, 1));
  EXPECT_EQ(best.at<cv::Vec2i>(0, 1), cv::Vec2i(-1, -1));
  EXPECT_EQ(best.at<cv::Vec2i>(1, 2), cv::Vec2i(6, 4));
}

TEST(BestPixels, TheMiddleOneWithoutConfidence) {
  const cv::Mat usable(6, 6, CV_8UC1, cv::Scalar(255));
  const cv::Mat best = bestPixels(usable, {}, 3);
  EXPECT_EQ(best.at<cv::Vec2i>(0, 0), cv::Vec2i(1, 1));
  EXPECT_EQ(best.at<cv::Vec2i>(1, 1), cv::Vec2i(4, 4));
}

}  // namespace
}  // namespace fdp_stereo
