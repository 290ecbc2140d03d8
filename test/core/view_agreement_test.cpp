// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "refinement/view_agreement.hpp"

#include <string>

#include <gtest/gtest.h>

#include "fdp_stereo/pipeline.hpp"
#include "fdp_stereo/pipeline_params.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr int kShiftPx = 5;
constexpr int kRows = 60, kCols = 120;

int answered(const cv::Mat& disparity) { return cv::countNonZero(disparity == disparity); }

/// `scene` moved by kShiftPx between the views, each with the noise of its own sensor.
SeenViews seen(const cv::Mat& scene, double noise) {
  cv::RNG random(7);
  const auto view = [&](int first) {
    cv::Mat values, image;
    scene.colRange(first, first + scene.cols - kShiftPx).convertTo(values, CV_32F);
    cv::Mat grain(values.size(), CV_32FC1);
    random.fill(grain, cv::RNG::NORMAL, 0.0, noise);
    cv::Mat(values + grain).convertTo(image, CV_8U);
    return image;
  };
  SeenViews views;
  views.left = view(0);
  views.right = view(kShiftPx);
  return views;
}

cv::Mat slope(double per_px) {
  cv::Mat scene(kRows, kCols + kShiftPx, CV_32FC1);
  for (int x = 0; x < scene.cols; ++x) scene.col(x).setTo(60.0 + per_px * x);
  return scene;
}

cv::Mat texture(double contrast) {
  cv::Mat scene;
  reference::noise(kRows, kCols + kShiftPx, CV_8UC1, 3).convertTo(scene, CV_32F, contrast / 255.0, 100.0);
  return scene;
}

int keptOf(const SeenViews& views) {
  cv::Mat disparity(kRows, kCols, CV_32FC1, cv::Scalar(kShiftPx));
  filterRegions(views, {}, disparity);
  return answered(disparity);
}

TEST(FilterRegions, DropsWhatIsNoiseInBothViews) {
  for (const double noise : {0.5, 2.0, 8.0}) {
    EXPECT_EQ(keptOf(seen(slope(0.0), noise)), 0) << noise;
    EXPECT_EQ(keptOf(seen(slope(0.3), noise)), 0) << noise;
  }
}

TEST(FilterRegions, KeepsTextureThatIsHardlyMoreThanTheNoise) {
  EXPECT_EQ(keptOf(seen(texture(100.0), 2.0)), kRows * kCols);
  EXPECT_EQ(keptOf(seen(texture(8.0), 2.0)), kRows * kCols);
}

TEST(FilterRegions, KeepsWhatAnotherSensorHasSeen) {
  SeenViews views = seen(slope(0.0), 2.0);
  views.vouched = cv::Mat::zeros(kRows, kCols, CV_8UC1);
  views.vouched.at<std::uint8_t>(20, 30) = 255;
  EXPECT_EQ(keptOf(views), kRows * kCols);
}

TEST(FilterRegions, JudgesRegionsApart) {
  SeenViews views = seen(slope(0.0), 2.0);
  const SeenViews textured = seen(texture(100.0), 2.0);
  const cv::Rect right_half(60, 0, 60, kRows);
  textured.left(right_half).copyTo(views.left(right_half));
  textured.right(right_half).copyTo(views.right(right_half));
  cv::Mat disparity(kRows, kCols, CV_32FC1, cv::Scalar(40));
  disparity(right_half).setTo(kShiftPx);
  filterRegions(views, {}, disparity);
  EXPECT_EQ(answered(disparity), right_half.area());
  EXPECT_EQ(answered(disparity(right_half)), right_half.area());
}

/// A lens cap, a white wall: a sensor's noise is all that there is to match.
TEST(Pipeline, DoesNotAnswerNoise) {
  for (const std::string& name : presetNames()) {
    PipelineParams params = loadPreset(name);
    params.search = {0, 32};
    params.local_expansion.iterations = 1;
    const bool slow = params.optimizer == OptimizerType::kLocalExpansion;
    for (const double noise : slow ? std::vector{2.0} : std::vector{1.0, 3.0}) {
      const SeenViews views = seen(cv::Mat(80, 120, CV_32FC1, cv::Scalar(90)), noise);
      const PipelineResult result = Pipeline(params).run(views.left, views.right);
      EXPECT_LE(answered(result.disparity), 0.01 * views.left.size().area()) << name << ", noise " << noise;
      EXPECT_LE(cv::mean(result.confidence)[0], 0.01) << name << ", noise " << noise;
    }
  }
}

}  // namespace
}  // namespace fdp_stereo
