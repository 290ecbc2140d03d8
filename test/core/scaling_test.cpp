// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/scaling.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"
#include "images/area_resampling.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

TEST(Scaling, OfOneChangesNothing) {
  const cv::Mat image = reference::texture(30, 40, CV_8UC3, 1);
  const StereoPair pair = prepareImages(image, image);
  const Scaling scaling(image.size(), 1.0);
  EXPECT_TRUE(scaling.identity());
  EXPECT_EQ(scaling.shrink(pair).left.data, image.data);
  EXPECT_EQ(scaling.shrink(DisparityRange{-3, 17}).min, -3);
  EXPECT_EQ(scaling.shrink(DisparityRange{-3, 17}).count, 17);
}

TEST(Scaling, HalvesImagesAndSharesTheGreyOne) {
  const cv::Mat grey = reference::texture(31, 40, CV_8UC1, 1);
  const Scaling scaling(grey.size(), 0.5);
  const StereoPair small = scaling.shrink(prepareImages(grey, grey));
  EXPECT_EQ(small.left.size(), cv::Size(20, 16));
  EXPECT_EQ(small.left.data, small.left_grey.data);
  const cv::Mat colour = reference::texture(31, 40, CV_8UC3, 1);
  EXPECT_EQ(scaling.shrink(prepareImages(colour, colour)).left_grey.size(), cv::Size(20, 16));
}

TEST(Scaling, SmallPixelsAreTheMeansOfTheirAreas) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const cv::Mat image = reference::texture(37, 83, type, 3);
    for (const cv::Size size : {cv::Size(83, 37), {46, 20}, {82, 36}, {1, 1}, {5, 37}}) {
      const cv::Mat small = shrinkByArea(image, size);
      cv::Mat expected;
      cv::resize(image, expected, size, 0.0, 0.0, cv::INTER_AREA);
      EXPECT_LE(cv::norm(small, expected, cv::NORM_INF), 1.0) << type << ", " << size;
      EXPECT_LE(cv::norm(small, expected, cv::NORM_L1), 0.02 * static_cast<double>(small.total()))
          << type << ", " << size;
    }
  }
}

TEST(Scaling, KeepsAPixelOfTheSmallestImage) {
  const cv::Mat image(1, 1, CV_8UC1, cv::Scalar(9));
  EXPECT_EQ(Scaling(image.size(), 0.25).shrink(prepareImages(image, image)).left.size(), cv::Size(1, 1));
}

TEST(Scaling, RangeCoversTheFullOne) {
  const Scaling scaling(cv::Size(100, 80), 0.5);
  for (const DisparityRange full :
       {DisparityRange{0, 64}, DisparityRange{0, 1}, DisparityRange{-7, 30}, DisparityRange{5, 2}}) {
    const DisparityRange small = scaling.shrink(full);
    EXPECT_LE(2 * small.min, full.min);
    EXPECT_GE(2 * small.max(), full.max());
    EXPECT_LE(small.count, full.count / 2 + 2);
  }
}

TEST(Scaling, SeedsMatchesAndRowsComeBack) {
  const Scaling scaling(cv::Size(100, 80), 0.5);
  const Seeds small = scaling.shrink(Seeds{{10.0F, 21.0F, 8.0F, 0.9F, SeedSource::kPoints}});
  // Full pixels 10 and 11 make up small pixel 5, whose centre lies at 10.5.
  EXPECT_FLOAT_EQ(small[0].x, 4.75F);
  EXPECT_FLOAT_EQ(small[0].y, 10.25F);
  EXPECT_FLOAT_EQ(small[0].d, 4.0F);
  const Seeds full = scaling.grow(small);
  EXPECT_FLOAT_EQ(full[0].x, 10.0F);
  EXPECT_FLOAT_EQ(full[0].d, 8.0F);
  const FeatureMatches matches = scaling.grow(FeatureMatches{{{4.75F, 10.25F}, {0.75F, 10.0F}, 1.0F}});
  EXPECT_FLOAT_EQ(matches[0].disparity(), 8.0F);
  EXPECT_FLOAT_EQ(matches[0].rowResidual(), 0.5F);
  RowAlignment rows;
  rows.model.size = {50, 40};
  rows.model.order = 1;
  rows.model.coefficients << 0.5, 0.1, -0.2, 0, 0, 0, 0;
  const double corner = rows.model.offsetAt(49, 39);
  EXPECT_NEAR(scaling.grow(rows).model.offsetAt(99, 79), 2.0 * corner, 1e-9);
}

/// Disparity of the small image that stands for full(x) = a + b x.
cv::Mat smallPlane(cv::Size small, double a, double b) {
  cv::Mat disparity(small, CV_32FC1);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) disparity.at<float>(y, x) = static_cast<float>(0.5 * (a + b * (2 * x + 0.5)));
  }
  return disparity;
}

TEST(Scaling, PlanesStayPlanes) {
  const cv::Mat image = reference::texture(40, 60, CV_8UC3, 3);
  const Scaling scaling(image.size(), 0.5);
  const StereoPair pair = prepareImages(image, image);
  const cv::Mat full = scaling.grow(smallPlane({30, 20}, 4.0, 0.3), scaling.shrink(pair).left, image, {0, 64});
  for (int y = 1; y < 39; ++y) {
    for (int x = 1; x < 59; ++x) ASSERT_NEAR(full.at<float>(y, x), 4.0 + 0.3 * x, 1e-4) << x << ", " << y;
  }
}

TEST(Scaling, EdgesFollowTheFullImage) {
  // Black up to column 20, white from 21 on: small column 10 is grey and was given the disparity of the white side.
  cv::Mat image(20, 40, CV_8UC1, cv::Scalar(0));
  image.colRange(21, 40).setTo(255);
  const Scaling scaling(image.size(), 0.5);
  cv::Mat disparity(10, 20, CV_32FC1, cv::Scalar(3.0F));
  disparity.colRange(10, 20).setTo(12.0F);
  const cv::Mat full = scaling.grow(disparity, scaling.shrink(prepareImages(image, image)).left, image, {0, 64});
  for (int x = 0; x < 40; ++x) EXPECT_FLOAT_EQ(full.at<float>(10, x), x < 21 ? 6.0F : 24.0F) << x;
}

TEST(Scaling, HolesStayHolesAndDisparitiesStayInTheRange) {
  const cv::Mat image = reference::texture(20, 40, CV_8UC1, 3);
  const Scaling scaling(image.size(), 0.5);
  cv::Mat disparity(10, 20, CV_32FC1, cv::Scalar(31.9F));
  disparity.at<float>(4, 6) = kInvalidDisparity;
  const cv::Mat full = scaling.grow(disparity, scaling.shrink(prepareImages(image, image)).left, image, {0, 63});
  EXPECT_EQ(full.total() - cv::countNonZero(full == full), 4U);
  EXPECT_TRUE(std::isnan(full.at<float>(8, 12)));
  EXPECT_FLOAT_EQ(full.at<float>(0, 0), 62.0F);
}

}  // namespace
}  // namespace fdp_stereo
