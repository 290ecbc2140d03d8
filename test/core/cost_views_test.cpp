// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/cost_views.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

cv::Mat sample(const std::string& side) {
  return readImage(FDP_STEREO_SOURCE_DIR "/sample/motorcycle/" + side + ".png");
}

cv::Mat noisy(const cv::Mat& image, double gain, double deviation) {
  cv::Mat noise(image.size(), CV_MAKETYPE(CV_32F, image.channels())), result;
  cv::RNG random(3);
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  image.convertTo(result, noise.type(), gain);
  result += noise;
  result.convertTo(result, CV_8U);
  return result;
}

cv::Mat compressed(const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> data;
  cv::imencode(".jpg", image, data, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(data, cv::IMREAD_UNCHANGED);
}

cv::Mat softened(const cv::Mat& image, double sigma_px) {
  cv::Mat result;
  cv::GaussianBlur(image, result, {}, sigma_px);
  return result;
}

CostSmoothing smoothingOf(const cv::Mat& left, const cv::Mat& right) {
  const StereoPair pair = prepareImages(left, right);
  return smoothingFor(measureQuality(pair.left_grey), measureQuality(pair.right_grey));
}

TEST(CostViews, GoodImagesStayAsTheyAre) {
  const StereoPair pair = prepareImages(sample("left"), sample("right"));
  const CostViews views = costViews(pair, {});
  EXPECT_EQ(views.pair.left_grey.data, pair.left_grey.data);
  EXPECT_EQ(views.pair.right_grey.data, pair.right_grey.data);
  EXPECT_EQ(views.params.lambda_rho, MatchingCostParams{}.lambda_rho);
}

TEST(CostViews, NoiseSmoothesTheCensus) {
  const CostSmoothing smoothing = smoothingOf(noisy(sample("left"), 0.25, 3.0), noisy(sample("right"), 0.25, 3.0));
  EXPECT_GT(smoothing.census_px, 0.9);
  EXPECT_EQ(smoothing.gradient_px, 0.0);
  EXPECT_GT(smoothing.lambda_factor, 2.0);
}

TEST(CostViews, CompressionSmoothesAll) {
  const CostSmoothing smoothing = smoothingOf(compressed(sample("left"), 30), compressed(sample("right"), 30));
  EXPECT_GT(smoothing.census_px, 1.0);
  EXPECT_GT(smoothing.gradient_px, 0.5);
}

TEST(CostViews, TheSharperViewIsMadeAsSoftAsTheOther) {
  const CostSmoothing smoothing = smoothingOf(sample("left"), softened(sample("right"), 1.5));
  EXPECT_NEAR(smoothing.left_px, 1.2, 0.3);
  EXPECT_EQ(smoothing.right_px, 0.0);
  EXPECT_EQ(smoothing.census_px, 0.0);
  EXPECT_GT(smoothingOf(softened(sample("left"), 1.5), sample("right")).right_px, 0.9);
}

TEST(CostViews, BlurOfBothViewsIsNoCompression) {
  const CostSmoothing smoothing = smoothingOf(softened(sample("left"), 1.5), softened(sample("right"), 1.5));
  EXPECT_EQ(smoothing.census_px, 0.0);
}

TEST(CostViews, LittleMoreNoiseSmoothesLittleMore) {
  const ImageQuality other;
  double before = 0.0;
  for (double noise = 0.0; noise < 0.6; noise += 0.01) {
    const double census_px = smoothingFor({noise, 1.0, 1.0}, other).census_px;
    EXPECT_GE(census_px, before);
    EXPECT_LT(census_px, before + 0.06);
    before = census_px;
  }
}

TEST(CostViews, AnyImageIsMeasured) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(40, 2), cv::Size(41, 9), cv::Size(3, 300), cv::Size(200, 200)}) {
    for (const cv::Mat& image :
         {cv::Mat(size, CV_8UC1, cv::Scalar(7)), reference::noise(size.height, size.width, CV_8UC1, 3)}) {
      const CostSmoothing smoothing = smoothingFor(measureQuality(image), {});
      EXPECT_GE(smoothing.census_px, 0.0);
      EXPECT_LE(smoothing.left_px, 2.0);
      EXPECT_LE(smoothing.right_px, 2.0);
    }
  }
}

TEST(CostViews, NoiseCostsLess) {
  const cv::Mat left = noisy(sample("left"), 0.25, 3.0), right = noisy(sample("right"), 0.25, 3.0);
  const cv::Mat truth = [&] {
    PipelineParams params;
    return Pipeline(params).run(sample("left"), sample("right")).disparity;
  }();
  const auto near = [&](bool adapt) {
    PipelineParams params;
    params.matching_cost.adapt = adapt;
    const cv::Mat disparity = Pipeline(params).run(left, right).disparity;
    return cv::countNonZero(cv::abs(disparity - truth) <= 1.0);
  };
  EXPECT_GT(near(true), near(false));
}

}  // namespace
}  // namespace fdp_stereo
