// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/blind_pixels.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "fdp_stereo/types.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

TEST(BlindPixels, AreFlatWindowsOf8And16Bit) {
  for (const double factor : {1.0, 200.0}) {
    cv::Mat image;
    reference::noise(40, 60, CV_8UC1, 1).convertTo(image, factor > 1.0 ? CV_16U : CV_8U, factor);
    EXPECT_EQ(cv::countNonZero(blindPixels(image)), 0);
    image(cv::Rect(10, 10, 5, 5)).setTo(77);
    EXPECT_EQ(cv::countNonZero(blindPixels(image)), 25);
    image(cv::Rect(30, 10, 15, 15)).setTo(255);
    image(cv::Rect(37, 10, 1, 15)).setTo(254);
    EXPECT_EQ(cv::countNonZero(blindPixels(image)), 25 + 225);
  }
}

TEST(BlackFrame, IsWhatTheBorderReachesThroughBlack) {
  cv::Mat image = reference::noise(40, 60, CV_8UC1, 2) / 2 + 60;
  EXPECT_TRUE(blackFrame(image).empty());
  image.col(20).setTo(0);
  EXPECT_TRUE(blackFrame(image).empty()) << "dark, but seen";
  image.colRange(0, 8).setTo(0);              // of the frame
  image(cv::Rect(30, 10, 6, 6)).setTo(0);     // black, but inside the picture
  image(cv::Rect(50, 0, 10, 10)).setTo(255);  // at the border, but not black
  cv::Mat expected = cv::Mat::zeros(image.size(), CV_8UC1);
  expected.colRange(0, 8).setTo(255);
  EXPECT_EQ(cv::countNonZero(blackFrame(image) != expected), 0);
}

TEST(BlackFrame, ThePictureGoesOnUnderIt) {
  cv::Mat image = (cv::Mat_<cv::Vec3b>(3, 5) << cv::Vec3b(), cv::Vec3b(), cv::Vec3b(), cv::Vec3b(), cv::Vec3b(),  //
                   cv::Vec3b(), cv::Vec3b(), cv::Vec3b(1, 2, 3), cv::Vec3b(4, 5, 6), cv::Vec3b(),                 //
                   cv::Vec3b(7, 7, 7), cv::Vec3b(), cv::Vec3b(), cv::Vec3b(), cv::Vec3b(8, 8, 8));
  const cv::Mat mask = (cv::Mat_<std::uint8_t>(3, 5) << 1, 1, 1, 1, 1, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0);
  const cv::Mat extended = extendUnder(mask, image);
  const auto row = [&](int y) {
    std::vector<int> firsts;
    for (int x = 0; x < 5; ++x) firsts.push_back(extended.at<cv::Vec3b>(y, x)[0]);
    return firsts;
  };
  EXPECT_EQ(row(0), (std::vector<int>{1, 4, 1, 4, 1})) << "as the nearest row";
  EXPECT_EQ(row(1), (std::vector<int>{1, 4, 1, 4, 1}));
  EXPECT_EQ(row(2), (std::vector<int>{7, 7, 7, 8, 8}));
  EXPECT_EQ(image.at<cv::Vec3b>(0, 0)[0], 0) << "the image itself is not touched";
  EXPECT_EQ(extendUnder(cv::Mat(), image).data, image.data);
}

/// NaN = none.
std::vector<float> explained(const std::vector<float>& row, const std::vector<std::uint8_t>& blind) {
  cv::Mat disparity = cv::Mat(row, true).reshape(1, 1);
  dropUnexplained(cv::Mat(blind).reshape(1, 1) * 255, disparity);
  return disparity;
}

TEST(BlindPixels, KeepWhatTheSeenOnesBesideThemExplain) {
  const float none = kInvalidDisparity;
  const std::vector<std::uint8_t> blind = {0, 0, 1, 1, 1, 1, 0, 0};
  const std::vector<float> kept = explained({none, 8, 8.5F, 20, 12, 3, none, 12}, blind);
  EXPECT_EQ(kept[2], 8.5F);
  EXPECT_TRUE(std::isnan(kept[3])) << "nearer than both";
  EXPECT_EQ(kept[4], 12.0F);
  EXPECT_TRUE(std::isnan(kept[5])) << "farther than both";
  EXPECT_EQ(kept[7], 12.0F);
}

TEST(BlindPixels, NothingExplainsBordersAndRowsWithoutAnswers) {
  const float none = kInvalidDisparity;
  const std::vector<float> border = explained({5, 5, 5, 5, 5, 5}, {1, 1, 0, 0, 1, 1});
  for (const int x : {0, 1, 4, 5}) EXPECT_TRUE(std::isnan(border[x])) << x;
  EXPECT_EQ(border[2], 5.0F);
  const std::vector<float> empty = explained({5, 5, none, 5, 5, 5, 5}, {0, 1, 0, 1, 1, 0, 1});
  EXPECT_TRUE(std::isnan(empty[1])) << "nothing is known to its right before the next blind pixels";
  for (const float d : explained({5, 5, 5}, {1, 1, 1})) EXPECT_TRUE(std::isnan(d));
}

}  // namespace
}  // namespace fdp_stereo
