// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/image_preparation.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

TEST(ImagePreparation, SharesWhatNeedsNoChange) {
  const cv::Mat grey = reference::noise(5, 7, CV_8UC1, 1);
  const StereoPair pair = prepareImages(grey, grey);
  EXPECT_EQ(pair.left.data, grey.data);
  EXPECT_EQ(pair.left_grey.data, grey.data);
}

TEST(ImagePreparation, KeepsColourAndAddsGrey) {
  const cv::Mat color = reference::noise(5, 7, CV_8UC3, 1);
  const StereoPair pair = prepareImages(color, color);
  EXPECT_EQ(pair.left.type(), CV_8UC3);
  ASSERT_EQ(pair.left_grey.type(), CV_8UC1);
  cv::Mat grey;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(cv::norm(pair.right_grey, grey, cv::NORM_INF), 0.0);
}

TEST(ImagePreparation, MakesMixedPairsGrey) {
  const StereoPair pair = prepareImages(reference::noise(5, 7, CV_8UC3, 1), reference::noise(5, 7, CV_8UC1, 2));
  EXPECT_EQ(pair.left.type(), CV_8UC1);
  EXPECT_EQ(pair.right.type(), CV_8UC1);
}

TEST(ImagePreparation, ShiftsBothViewsOf16BitAlike) {
  const cv::Mat left = (cv::Mat_<std::uint16_t>(1, 3) << 0, 512, 1023);  // 10 bits: shifted by 2
  const cv::Mat right = (cv::Mat_<std::uint16_t>(1, 3) << 4, 8, 12);
  const StereoPair pair = prepareImages(left, right);
  ASSERT_EQ(pair.left.type(), CV_8UC1);
  EXPECT_EQ(pair.left.at<std::uint8_t>(0, 1), 128);
  EXPECT_EQ(pair.left.at<std::uint8_t>(0, 2), 255);
  EXPECT_EQ(pair.right.at<std::uint8_t>(0, 2), 3);
  EXPECT_EQ(cv::norm(pair.left_grey, left, cv::NORM_INF), 0.0) << "census keeps the full depth";
}

TEST(ImagePreparation, NeverModifiesItsInput) {
  const cv::Mat left = reference::noise(5, 7, CV_8UC3, 1);
  const cv::Mat copy = left.clone();
  prepareImages(left, reference::noise(5, 7, CV_8UC1, 2));
  EXPECT_EQ(cv::norm(left, copy, cv::NORM_INF), 0.0);
}

TEST(ImagePreparation, RefusesWhatDoesNotFit) {
  const cv::Mat image(5, 7, CV_8UC1, cv::Scalar(1));
  EXPECT_THROW(prepareImages(image, cv::Mat(5, 8, CV_8UC1, cv::Scalar(1))), std::invalid_argument);
  EXPECT_THROW(prepareImages(image, cv::Mat()), std::invalid_argument);
  EXPECT_THROW(prepareImages(cv::Mat(), cv::Mat()), std::invalid_argument);
  EXPECT_THROW(prepareImages(cv::Mat(5, 7, CV_32FC1), cv::Mat(5, 7, CV_32FC1)), std::invalid_argument);
  EXPECT_THROW(prepareImages(cv::Mat(5, 7, CV_8UC4), cv::Mat(5, 7, CV_8UC4)), std::invalid_argument);
  EXPECT_THROW(prepareImages(image, cv::Mat(5, 7, CV_16UC1)), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
