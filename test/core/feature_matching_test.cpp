// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/feature_matching.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"

namespace fdp_stereo {
namespace {

/// Smooth random texture, wider than needed, to cut both views from.
cv::Mat texture(cv::Size size, int seed) {
  cv::RNG rng(seed);
  cv::Mat noise(size, CV_8UC1);
  rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::Mat smooth;
  cv::GaussianBlur(noise, smooth, {}, 1.6);
  cv::normalize(smooth, smooth, 0, 255, cv::NORM_MINMAX);
  return smooth;
}

/// Left view and a right view in which everything lies `disparity` to the left and `row` px higher.
StereoPair shifted(double disparity, double row, int channels = 1) {
  const cv::Mat source = texture({320, 200}, 3);
  StereoPair pair;
  const auto cut = [&](double dx, double dy) {
    cv::Mat out;
    cv::getRectSubPix(source, cv::Size(240, 160),
                      cv::Point2f(160.0F + static_cast<float>(dx), 100.0F + static_cast<float>(dy)), out);
    if (channels == 3) cv::cvtColor(out, out, cv::COLOR_GRAY2BGR);
    return out;
  };
  pair.left = cut(0, 0);
  pair.right = cut(disparity, row);
  return pair;
}

StereoPair views(const cv::Mat& left, const cv::Mat& right) {
  StereoPair pair;
  pair.left = left;
  pair.right = right;
  return pair;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

FeatureMatchingParams paramsOf(FeatureDetector detector) {
  FeatureMatchingParams params;
  params.detector = detector;
  params.max_ratio = detector == FeatureDetector::kSift ? 0.6 : 0.8;
  params.max_row_difference_px = 3.0;
  params.max_features = 1000;
  return params;
}

class EachDetector : public ::testing::TestWithParam<FeatureDetector> {};

TEST_P(EachDetector, FindsAKnownShiftToAFractionOfAPixel) {
  for (const int channels : {1, 3}) {
    const FeatureMatching found = matchFeatures(shifted(11.3, 0.6, channels), {0, 32}, paramsOf(GetParam()));
    ASSERT_GT(found.matches.size(), 50U);
    std::vector<double> disparity_error;
    std::vector<double> row_error;
    for (const FeatureMatch& m : found.matches) {
      disparity_error.push_back(std::abs(m.disparity() - 11.3));
      row_error.push_back(std::abs(m.rowResidual() - 0.6));
      EXPECT_GT(m.trust, 0.0F);
      EXPECT_LE(m.trust, 1.0F);
    }
    EXPECT_LT(median(disparity_error), 0.05);
    EXPECT_LT(median(row_error), 0.05);
  }
}

TEST_P(EachDetector, KeepsToRangeAndRows) {
  FeatureMatchingParams params = paramsOf(GetParam());
  EXPECT_TRUE(matchFeatures(shifted(11.3, 0.6), {15, 8}, params).matches.size() < 5);
  params.max_row_difference_px = 0.3;
  for (const FeatureMatch& m : matchFeatures(shifted(11.3, 0.6), {0, 32}, params).matches) {
    EXPECT_LE(std::abs(m.rowResidual()), 0.3);
  }
  params = paramsOf(GetParam());
  const FeatureMatching negative = matchFeatures(shifted(-7.0, 0.0), {-16, 17}, params);
  ASSERT_GT(negative.matches.size(), 50U);
  EXPECT_NEAR(negative.matches[negative.matches.size() / 2].disparity(), -7.0, 0.5);
}

TEST_P(EachDetector, SortedAndUnique) {
  const FeatureMatches matches = matchFeatures(shifted(5.0, 0.0), {0, 32}, paramsOf(GetParam())).matches;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    const cv::Point2f a = matches[i - 1].left;
    const cv::Point2f b = matches[i].left;
    EXPECT_TRUE(a.y < b.y || (a.y == b.y && a.x < b.x));
  }
}

TEST_P(EachDetector, NothingToMatchIsNoError) {
  const FeatureMatchingParams params = paramsOf(GetParam());
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(7, 5), cv::Size(1, 1), cv::Size(200, 1)}) {
    const cv::Mat flat(size, CV_8UC1, cv::Scalar(90));
    EXPECT_TRUE(matchFeatures(prepareImages(flat, flat), {0, 16}, params).matches.empty());
  }
}

TEST_P(EachDetector, FeaturesAreLimited) {
  FeatureMatchingParams params = paramsOf(GetParam());
  params.max_features = 10;  // far fewer than there are cells of the image
  EXPECT_LE(matchFeatures(shifted(11.3, 0.0), {0, 32}, params).matches.size(), 10U);
}

TEST_P(EachDetector, RepeatsItself) {
  const StereoPair pair = shifted(9.0, 0.2);
  const FeatureMatches once = matchFeatures(pair, {0, 32}, paramsOf(GetParam())).matches;
  cv::setNumThreads(1);
  const FeatureMatches again = matchFeatures(pair, {0, 32}, paramsOf(GetParam())).matches;
  cv::setNumThreads(-1);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].left, again[i].left);
    EXPECT_EQ(once[i].right, again[i].right);
  }
}

INSTANTIATE_TEST_SUITE_P(Detectors, EachDetector,
                         ::testing::Values(FeatureDetector::kSift, FeatureDetector::kOrb,
                                           FeatureDetector::kFastCensus));

TEST(FeatureMatching, StricterRatioKeepsFewer) {
  StereoPair pair = shifted(9.0, 0.0);
  cv::Mat noise(pair.right.size(), CV_8UC1);
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 40);
  pair.right += noise;
  FeatureMatchingParams params = paramsOf(FeatureDetector::kFastCensus);
  const std::size_t loose = matchFeatures(pair, {0, 64}, params).matches.size();
  params.max_ratio = 0.3;
  EXPECT_LT(matchFeatures(pair, {0, 64}, params).matches.size(), loose);
}

TEST(FeatureMatching, RejectsViewsThatDoNotFit) {
  const cv::Mat image(20, 20, CV_8UC1, cv::Scalar(0));
  const cv::Mat other(20, 21, CV_8UC1, cv::Scalar(0));
  const cv::Mat wide(20, 20, CV_16UC1, cv::Scalar(0));
  EXPECT_THROW(matchFeatures(views(image, other), {0, 16}, {}), std::invalid_argument);
  EXPECT_THROW(matchFeatures(views(wide, wide), {0, 16}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
