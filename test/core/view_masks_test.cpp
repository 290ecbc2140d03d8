// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/view_masks.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"

namespace fdp_stereo {
namespace {

const cv::Rect kLeftArm(60, 40, 50, 80);
const cv::Rect kRightArm(30, 40, 50, 80);

cv::Mat maskOf(cv::Size size, cv::Rect arm) {
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  mask(arm).setTo(255);
  return mask;
}

/// The pair of the sample, with an arm of another texture for each number; part of it fills the masks.
class Masked : public ::testing::TestWithParam<std::string> {
 protected:
  Masked() {
    const std::string folder = FDP_STEREO_SOURCE_DIR "/sample/motorcycle/";
    cv::resize(readImage(folder + "left.png"), left_, {240, 160}, 0, 0, cv::INTER_AREA);
    cv::resize(readImage(folder + "right.png"), right_, {240, 160}, 0, 0, cv::INTER_AREA);
    params_ = loadPreset(GetParam());
    params_.search = {0, 32};
    params_.local_expansion.iterations = 1;
  }
  PipelineResult run(int arm) const {
    cv::Mat left = left_.clone();
    cv::Mat right = right_.clone();
    cv::RNG rng(static_cast<std::uint64_t>(arm));
    for (auto& [image, place] : {std::pair(left, kLeftArm), std::pair(right, kRightArm)}) {
      cv::Mat part = image(cv::Rect(place.x, place.y, place.width, 20 + 20 * (arm % 4)));
      rng.fill(part, cv::RNG::UNIFORM, 0, 256);
    }
    Pipeline pipeline(params_);
    pipeline.setMasks(maskOf(left.size(), kLeftArm), maskOf(right.size(), kRightArm));
    return pipeline.run(left, right);
  }
  cv::Mat left_, right_;
  PipelineParams params_;
};

void expectSame(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(cv::countNonZero(a != b), cv::countNonZero(a != a));  // NaN differs from itself
  EXPECT_EQ(cv::countNonZero(a != a), cv::countNonZero(b != b));
}

TEST_P(Masked, WhatMovesUnderTheMaskChangesNothing) {
  for (const double scale : {1.0, 0.5}) {
    params_.scale = scale;
    const PipelineResult first = run(1);
    for (const int arm : {2, 3}) {
      const PipelineResult other = run(arm);
      expectSame(first.disparity, other.disparity);
      expectSame(first.confidence, other.confidence);
      expectSame(first.sigma, other.sigma);
    }
  }
}

TEST_P(Masked, NothingIsKnownUnderTheMask) {
  for (const bool fill : {false, true}) {
    params_.hole_filling.enabled = fill;
    const PipelineResult result = run(1);
    const cv::Mat disparity = result.disparity(kLeftArm);
    EXPECT_EQ(cv::countNonZero(disparity == disparity), 0);
    EXPECT_EQ(cv::countNonZero(result.confidence(kLeftArm)), 0);
    EXPECT_GT(cv::countNonZero(result.disparity == result.disparity), 240 * 160 / 2);
    for (const Seeds* seeds : {&result.seeds, &result.quasi_dense_seeds}) {
      for (const Seed& seed : *seeds) {
        EXPECT_FALSE(kLeftArm.contains(cv::Point(cvRound(seed.x), cvRound(seed.y)))) << seed.x << ' ' << seed.y;
      }
    }
  }
}

TEST_P(Masked, NoAnswerLeadsUnderTheMaskOfTheRight) {
  params_.hole_filling.enabled = false;
  params_.hole_closing.enabled = false;
  const cv::Mat disparity = run(1).disparity;
  int inside = 0;
  for (int y = kRightArm.y + 4; y < kRightArm.br().y - 4; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const float match = static_cast<float>(x) - disparity.at<float>(y, x);
      inside += match > static_cast<float>(kRightArm.x + 4) && match < static_cast<float>(kRightArm.br().x - 5) ? 1 : 0;
    }
  }
  EXPECT_EQ(inside, 0);
}

TEST_P(Masked, AMaskOfAnotherSizeIsAnError) {
  Pipeline pipeline(params_);
  pipeline.setMasks({}, cv::Mat(80, 120, CV_8UC1, cv::Scalar(0)));
  try {
    pipeline.run(left_, right_);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("right mask of 120 x 80"), std::string::npos) << text;
    EXPECT_NE(text.find("240 x 160"), std::string::npos) << text;
  }
  pipeline.setMasks({}, {});
  EXPECT_NO_THROW(pipeline.run(left_, right_));
}

TEST_P(Masked, EverythingMasked) {
  Pipeline pipeline(params_);
  const cv::Mat all(left_.size(), CV_8UC1, cv::Scalar(255));
  pipeline.setMasks(all, all);
  const cv::Mat disparity = pipeline.run(left_, right_).disparity;
  EXPECT_EQ(cv::countNonZero(disparity == disparity), 0);
}

INSTANTIATE_TEST_SUITE_P(Presets, Masked, ::testing::Values("fast", "accurate"),
                         [](const auto& preset) { return preset.param; });

TEST(ViewMasks, ASmallPixelOfAnyMaskedOneIsMasked) {
  cv::Mat mask(9, 9, CV_8UC1, cv::Scalar(0));
  mask.at<std::uint8_t>(4, 4) = 1;
  const cv::Mat small = shrinkMasks({mask, {}}, {4, 4}).left;
  EXPECT_GE(cv::countNonZero(small), 1);
  EXPECT_EQ(small.type(), CV_8UC1);
}

}  // namespace
}  // namespace fdp_stereo
