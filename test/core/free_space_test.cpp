// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/free_space.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>

#include <gtest/gtest.h>

#include "evaluation/scene.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace {

constexpr int kSpacing = 8;
constexpr double kFocal = 500.0;

cv::Mat wall(float disparity) { return cv::Mat(80, 120, CV_32FC1, cv::Scalar(disparity)); }
cv::Mat freeOf(const cv::Mat& map) { return freeDisparity(map, {}, kFocal, kSpacing); }

TEST(FreeSpace, UpToAPixelBeforeAWall) {
  const cv::Mat free = freeOf(wall(20.0F));
  ASSERT_EQ(free.size(), cv::Size(15, 10));
  EXPECT_EQ(cv::countNonZero(free == 21.0F), 150);
}

TEST(FreeSpace, SquaresThatAreCutOffCountToo) {
  const cv::Mat free = freeOf(wall(20.0F)(cv::Rect(0, 0, 61, 50)));
  ASSERT_EQ(free.size(), cv::Size(8, 7));
  EXPECT_EQ(cv::countNonZero(free == 21.0F), 56);
  EXPECT_EQ(rayPixel({7, 6}, kSpacing, {61, 50}), cv::Point(60, 49));
}

TEST(FreeSpace, NoRayPassesCloseByANearThing) {
  cv::Mat map = wall(20.0F);
  map.at<float>(36, 60) = 40.0F;
  const cv::Mat free = freeOf(map);
  EXPECT_FLOAT_EQ(free.at<float>(4, 7), 41.0F);
  EXPECT_FLOAT_EQ(free.at<float>(4, 8), 41.0F) << "the square beside it";
  EXPECT_FLOAT_EQ(free.at<float>(4, 10), 21.0F);
}

TEST(FreeSpace, AGapIsFreeUpToTheNearerSideLessItsBulge) {
  cv::Mat map = wall(20.0F);
  map.colRange(0, 40).setTo(30.0F);
  map.colRange(40, 80).setTo(kInvalidDisparity);
  const cv::Mat free = freeOf(map);
  const double bulge = 40.0 / (2.0 * kFocal);
  EXPECT_NEAR(free.at<float>(5, 7), 31.0 / (1.0 - bulge), 1e-3);
  EXPECT_FLOAT_EQ(free.at<float>(5, 12), 21.0F);
}

TEST(FreeSpace, SomethingAnsweredInAGapBoundsIt) {
  cv::Mat map = wall(20.0F);
  map.colRange(40, 80).setTo(kInvalidDisparity);
  map.at<float>(44, 60) = 50.0F;
  const cv::Mat free = freeOf(map);
  EXPECT_GT(free.at<float>(5, 5), 51.0F) << "a thing that the gap holds may be as wide as the gap";
}

TEST(FreeSpace, WhatIsNotEnclosedIsNotKnown) {
  cv::Mat map = wall(20.0F);
  map(cv::Rect(0, 0, 40, 40)).setTo(kInvalidDisparity);
  const cv::Mat free = freeOf(map);
  EXPECT_TRUE(std::isnan(free.at<float>(1, 1)));
  EXPECT_EQ(cv::countNonZero(freeOf(wall(kInvalidDisparity)) == freeOf(wall(kInvalidDisparity))), 0);
}

TEST(FreeSpace, AnAnswerThatIsNotTrustedBoundsButTellsNothing) {
  cv::Mat map = wall(20.0F);
  map(cv::Rect(40, 0, 40, 80)).setTo(35.0F);
  cv::Mat trusted(map.size(), CV_8UC1, cv::Scalar(255));
  trusted(cv::Rect(40, 0, 40, 80)).setTo(0);
  EXPECT_GT(freeDisparity(map, trusted, kFocal, kSpacing).at<float>(5, 7), 36.0F);
  trusted.setTo(0);
  const cv::Mat free = freeDisparity(map, trusted, kFocal, kSpacing);
  EXPECT_EQ(cv::countNonZero(free == free), 0);
}

TEST(FreeSpace, BeyondInfinityIsInfinitelyFar) { EXPECT_FLOAT_EQ(freeOf(wall(-0.5F)).at<float>(3, 3), 1.0F); }

struct Tally {
  int rays = 0;
  int through_surfaces = 0;
  int unanswered = 0;
  int cleared = 0;
};

/// Rays against the truth with a tolerance of 5 % of the depth; of the pixels without answer, those right of the strip
/// that the right camera does not see.
void tally(const Scene& scene, Tally& sum) {
  PipelineParams params = loadPreset("fast");
  params.search = {0, scene.num_disparities};
  Pipeline pipeline(params);
  pipeline.setQuality(Pipeline::Quality::kEstimated);
  const PipelineResult result = pipeline.run(scene.left, scene.right);
  const cv::Mat& disparity = result.disparity;
  const cv::Mat free = freeDisparity(disparity, result.confidence >= kSureOfFree, 1000.0, kSpacing);
  for (int y = 0; y < free.rows; ++y) {
    for (int x = 0; x < free.cols; ++x) {
      const cv::Point pixel = rayPixel({x, y}, kSpacing, disparity.size());
      const float truth = scene.truth.at<float>(pixel);
      if (std::isnan(truth) || std::isnan(free.at<float>(y, x))) continue;
      ++sum.rays;
      if (free.at<float>(y, x) * 1.05F < truth) ++sum.through_surfaces;
    }
  }
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const float truth = scene.truth.at<float>(y, x);
      if (std::isnan(truth) || static_cast<float>(x) < truth || !std::isnan(disparity.at<float>(y, x))) continue;
      ++sum.unanswered;
      if (!std::isnan(free.at<float>(y / kSpacing, x / kSpacing))) ++sum.cleared;
    }
  }
}

class FreeSpaceOfScenes : public ::testing::TestWithParam<const char*> {};

TEST_P(FreeSpaceOfScenes, HoldsAgainstTheTruth) {
  const std::string folder = std::string(FDP_STEREO_SOURCE_DIR "/../shared/data/") + GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  Tally sum;
  for (const SceneFiles& files : findScenes(folder)) tally(readScene(files), sum);
  std::cout << sum.through_surfaces << " of " << sum.rays << " rays clear a surface; " << sum.cleared << " of "
            << sum.unanswered << " pixels without answer are cleared\n";
  EXPECT_LE(sum.through_surfaces, 0.001 * sum.rays);
  EXPECT_GE(sum.cleared, 0.5 * sum.unanswered);
}

INSTANTIATE_TEST_SUITE_P(Sets, FreeSpaceOfScenes,
                         ::testing::Values("MiddEval3-trainingQ", "Middlebury-2005-2006", "KITTI2012",
                                           "Middlebury-v2"));

}  // namespace
}  // namespace fdp_stereo
