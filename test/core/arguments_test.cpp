// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
// What the stages after the matching say of maps and images that do not fit.
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "fdp_stereo/disparity_smoothing.hpp"
#include "fdp_stereo/hidden_pixels.hpp"
#include "fdp_stereo/hole_closing.hpp"
#include "fdp_stereo/hole_filling.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/left_right_check.hpp"
#include "fdp_stereo/quasi_dense.hpp"
#include "fdp_stereo/semi_global.hpp"
#include "fdp_stereo/sparse_disparity.hpp"
#include "fdp_stereo/speckle_filter.hpp"
#include "fdp_stereo/weighted_median.hpp"

namespace fdp_stereo {
namespace {

const cv::Mat kImage(6, 8, CV_8UC1, cv::Scalar(9));

TEST(Arguments, MapsOfAnotherTypeAreRefused) {
  const std::vector<std::function<void(cv::Mat&)>> stages = {
      [](cv::Mat& map) { checkLeftRight(map, cv::Mat(6, 8, CV_32FC1, cv::Scalar(1)), {}); },
      [](cv::Mat& map) { filterSpeckles(map, {}); },
      [](cv::Mat& map) { closeHoles(map); },
      [](cv::Mat& map) { fillHoles(map, 0); },
      [](cv::Mat& map) { filterWeightedMedian(map, kImage, {}); },
      [](cv::Mat& map) { smoothDisparity(map, kImage, {}); },
      [](cv::Mat& map) { dropHidden(map); },
      [](cv::Mat& map) {
        colorize(map, {0, 8});
      },
      [](cv::Mat& map) { confidenceToGrey(map); }};
  for (std::size_t i = 0; i < stages.size(); ++i) {
    for (cv::Mat map : {cv::Mat(), cv::Mat(6, 8, CV_8UC1), cv::Mat(6, 8, CV_64FC1), cv::Mat(6, 8, CV_32FC3)}) {
      EXPECT_THROW(stages[i](map), std::invalid_argument) << "stage " << i << ", type " << map.type();
    }
    cv::Mat fits(6, 8, CV_32FC1, cv::Scalar(1));
    EXPECT_NO_THROW(stages[i](fits)) << "stage " << i;
  }
}

TEST(Arguments, ImagesAndMapsOfAnotherSizeAreRefused) {
  cv::Mat map(6, 8, CV_32FC1, cv::Scalar(1));
  EXPECT_THROW(checkLeftRight(map, map.rowRange(1, 6), {}), std::invalid_argument);
  for (const cv::Mat& image : {cv::Mat(), kImage.colRange(1, 8).clone(), cv::Mat(6, 8, CV_16UC1)}) {
    EXPECT_THROW(filterWeightedMedian(map, image, {}), std::invalid_argument);
    EXPECT_THROW(smoothDisparity(map, image, {}), std::invalid_argument);
  }
  EXPECT_THROW(drawSeeds(cv::Mat(6, 8, CV_32FC1), {}, {0, 8}), std::invalid_argument);
}

TEST(Arguments, SeedsThatAreNoNumbersAreNotDrawn) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const Seed seed{kNaN, 1.0F, 2.0F};
  EXPECT_EQ(cv::norm(drawSeeds(kImage, {{seed}, {seed}}, {0, 8}), drawSeeds(kImage, {}, {0, 8})), 0.0);
}

TEST(Arguments, QuasiDenseStepsAreAtLeastOne) {
  CostVolume volume;
  volume.create(6, 8, {0, 4}, CostVolume::Depth::kU8, 0.01F, 255);
  SemiGlobalMatcher matcher;
  QuasiDenseParams params;
  params.row_step = 0;
  EXPECT_THROW(matchRoughly(volume, kImage, params, {}, matcher), std::invalid_argument);
  params = {};
  params.spacing_px = 0;
  EXPECT_THROW(matchRoughly(volume, kImage, params, {}, matcher), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
