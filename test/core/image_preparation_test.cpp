// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/image_preparation.hpp"

#include <utility>

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

cv::Mat_<std::uint16_t> sixteenBit(const cv::Mat& image, double factor, double offset) {
  cv::Mat result;
  image.convertTo(result, CV_16U, factor, offset);
  return result;
}

TEST(ImagePreparation, BringsBothViewsOf16BitAlikeTo8) {
  const cv::Mat grey = reference::noise(40, 60, CV_8UC1, 1);
  const cv::Mat left = sixteenBit(grey, 4.0, 0.0);
  const StereoPair pair = prepareImages(left, left / 2);
  ASSERT_EQ(pair.left.type(), CV_8UC1);
  EXPECT_LE(cv::norm(pair.left, grey, cv::NORM_INF), 4.0);
  EXPECT_LE(cv::norm(pair.right, grey / 2, cv::NORM_INF), 4.0);
  EXPECT_EQ(cv::norm(pair.left_grey, left, cv::NORM_INF), 0.0) << "census keeps the full depth";
}

TEST(ImagePreparation, OffsetsAndFactorsOf16BitCostNothing) {
  const cv::Mat left = reference::noise(40, 60, CV_8UC3, 1), right = reference::noise(40, 60, CV_8UC3, 2);
  const auto prepared = [&](double factor, double offset) {
    return prepareImages(sixteenBit(left, factor, offset), sixteenBit(right, factor, offset));
  };
  const StereoPair plain = prepared(4.0, 1.0);
  for (const auto& [factor, offset] : {std::pair(4.0, 1000.0), {4.0, 64000.0}, {16.0, 1.0}, {250.0, 1000.0}}) {
    EXPECT_LE(cv::norm(plain.left, prepared(factor, offset).left, cv::NORM_INF), 1.0) << factor << ' ' << offset;
    EXPECT_LE(cv::norm(plain.right, prepared(factor, offset).right, cv::NORM_INF), 1.0) << factor << ' ' << offset;
  }
}

TEST(ImagePreparation, HotPixelsLampsAndBordersOf16BitCostNothing) {
  const cv::Mat grey = reference::noise(100, 100, CV_8UC1, 1);
  const auto image = sixteenBit(grey, 4.0, 1000.0);
  const cv::Mat plain = toEightBit(image);
  auto spoilt = image.clone();
  spoilt(cv::Rect(20, 20, 6, 6)).setTo(65535);
  spoilt(cv::Rect(0, 90, 100, 10)).setTo(0);
  cv::Mat difference;
  cv::absdiff(toEightBit(spoilt), plain, difference);
  difference(cv::Rect(20, 20, 6, 6)).setTo(0);
  difference(cv::Rect(0, 90, 100, 10)).setTo(0);
  EXPECT_LE(cv::norm(difference, cv::NORM_INF), 2.0);
}

TEST(ImagePreparation, NeverEnlargesDifferencesOf16Bit) {
  const auto faint = sixteenBit(reference::noise(40, 60, CV_8UC1, 1) / 64, 1.0, 500.0);
  double darkest = 0.0, brightest = 0.0;
  cv::minMaxLoc(toEightBit(faint), &darkest, &brightest);
  EXPECT_EQ(brightest - darkest, 4.0) << "as in the image";
  for (const int value : {0, 1, 700, 65535}) {  // no range at all
    const cv::Mat flat(4, 4, CV_16UC1, cv::Scalar(value));
    EXPECT_EQ(cv::norm(toEightBit(flat), cv::NORM_INF), 0.0) << value;
  }
}

TEST(ImagePreparation, KeepsTheRangeOf16BitWhileItFits) {
  const cv::Mat grey = reference::noise(40, 60, CV_8UC1, 1);
  ValueRange range;
  const auto prepared = [&](double factor) {
    return prepareImages(sixteenBit(grey, factor, 0.0), sixteenBit(grey, factor, 0.0), range).left;
  };
  const cv::Mat first = prepared(4.0);
  const ValueRange before = range;
  prepared(4.2);
  EXPECT_EQ(range.white, before.white) << "a little brighter";
  const cv::Mat doubled = prepared(8.0);
  EXPECT_GT(range.white, before.white);
  EXPECT_LE(cv::norm(doubled, first, cv::NORM_INF), 1.0);
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
