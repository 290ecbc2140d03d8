// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hole_closing.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reference/post_processing_reference.hpp"

namespace fdp_stereo {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(HoleClosing, AHoleInsideASlantedSurfaceIsClosedFromIt) {
  cv::Mat disparity(20, 20, CV_32FC1);
  for (int x = 0; x < 20; ++x) disparity.col(x).setTo(2.0 + 0.5 * x);
  disparity.at<float>(10, 12) = disparity.at<float>(10, 13) = kNone;
  const cv::Mat closed = closeHoles(disparity);
  EXPECT_EQ(cv::countNonZero(closed), 2);
  EXPECT_EQ(closed.at<std::uint8_t>(10, 12), 255);
  EXPECT_NEAR(disparity.at<float>(10, 12), 8.0F, 0.2F);
  EXPECT_NEAR(disparity.at<float>(10, 13), 8.5F, 0.2F);
}

TEST(HoleClosing, NothingIsMadeBetweenTwoSurfaces) {
  cv::Mat disparity(20, 40, CV_32FC1, cv::Scalar(4.0));
  disparity.colRange(20, 40).setTo(12.0);
  disparity.colRange(19, 21).setTo(kNone);
  closeHoles(disparity);
  const cv::Mat between = (disparity > 4.0F) & (disparity < 12.0F);
  EXPECT_EQ(cv::countNonZero(between), 0);
}

TEST(HoleClosing, LargeHolesKeepTheirMiddle) {
  cv::Mat disparity(40, 40, CV_32FC1, cv::Scalar(4.0));
  disparity(cv::Rect(10, 10, 20, 20)).setTo(kNone);
  closeHoles(disparity);
  EXPECT_EQ(cv::countNonZero(disparity(cv::Rect(12, 12, 16, 16)) == 4.0F), 0);
}

TEST(HoleClosing, WhatTheRightViewCannotSeeStays) {
  cv::Mat disparity(9, 9, CV_32FC1, cv::Scalar(4.0));
  disparity.at<float>(4, 3) = disparity.at<float>(4, 6) = kNone;
  closeHoles(disparity);
  EXPECT_TRUE(std::isnan(disparity.at<float>(4, 3)));
  EXPECT_EQ(disparity.at<float>(4, 6), 4.0F);
}

TEST(HoleClosing, EmptyAndTinyMapsStay) {
  cv::Mat none(4, 5, CV_32FC1, cv::Scalar(kNone));
  EXPECT_EQ(cv::countNonZero(closeHoles(none)), 0);
  cv::Mat one(1, 1, CV_32FC1, cv::Scalar(0.0F));
  EXPECT_EQ(cv::countNonZero(closeHoles(one)), 0);
}

}  // namespace
}  // namespace fdp_stereo
