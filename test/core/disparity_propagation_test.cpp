// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/disparity_propagation.hpp"

#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

#include "reference/disparity_propagation_reference.hpp"

namespace fdp_stereo {
namespace {

CostVolume constantVolume(cv::Size size, DisparityRange range, CostVolume::Depth depth, int value) {
  CostVolume volume;
  volume.create(size.height, size.width, range, depth, 0.01F, 255);
  volume.clearPadding();
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int i = 0; i < range.count; ++i) volume.setRaw(y, x, i, value);
    }
  }
  return volume;
}

DisparityPropagationParams windowParams(int window, double gamma) {
  DisparityPropagationParams params;
  params.form = PropagationForm::kWindow;
  params.window = window;
  params.gamma = gamma;
  return params;
}

Seed seedAt(float x, float y, float d) {
  Seed seed;
  seed.x = x;
  seed.y = y;
  seed.d = d;
  return seed;
}

// gamma = 10, raw cost 200, one seed at (1, 0) with d = 2.4 -> 2 in a row of greys 50 53 60:
// w = exp(-3 / 10) = 0.740818, exp(0) = 1, exp(-7 / 10) = 0.496585; 200 (1 - w) = 51.84, 0, 100.68.
TEST(DisparityPropagation, HandWorkedCase) {
  const cv::Mat left = (cv::Mat_<uchar>(1, 3) << 50, 53, 60);
  CostVolume volume = constantVolume(left.size(), {0, 4}, CostVolume::Depth::kU8, 200);
  const double share = propagateDisparity({seedAt(1, 0, 2.4F)}, left, windowParams(3, 10.0), volume);
  EXPECT_EQ(volume.raw(0, 0, 2), 52);
  EXPECT_EQ(volume.raw(0, 1, 2), 0);
  EXPECT_EQ(volume.raw(0, 2, 2), 101);
  for (const int other : {0, 1, 3}) EXPECT_EQ(volume.raw(0, 0, other), 200);
  EXPECT_DOUBLE_EQ(share, 1.0);
}

// Colour distances add up over the channels: |1| + |2| + |4| = 7.
TEST(DisparityPropagation, ColourIsTheSumOverChannels) {
  const cv::Mat left = (cv::Mat_<cv::Vec3b>(1, 2) << cv::Vec3b(10, 20, 30), cv::Vec3b(11, 22, 26));
  CostVolume volume = constantVolume(left.size(), {0, 2}, CostVolume::Depth::kU16, 200);
  propagateDisparity({seedAt(0, 0, 1)}, left, windowParams(3, 10.0), volume);
  EXPECT_EQ(volume.raw(0, 1, 1), 101);
}

class PropagationReference : public ::testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(PropagationReference, EqualToTheBit) {
  const auto [seed, channels, bits] = GetParam();
  cv::RNG rng(seed);
  const cv::Size size(1 + rng.uniform(0, 40), 1 + rng.uniform(0, 30));
  const DisparityRange range{-3 + rng.uniform(0, 6), 1 + rng.uniform(0, 20)};
  cv::Mat left(size, CV_8UC(channels));
  rng.fill(left, cv::RNG::UNIFORM, 0, 60);
  CostVolume volume = constantVolume(size, range, bits == 8 ? CostVolume::Depth::kU8 : CostVolume::Depth::kU16, 255);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int i = 0; i < range.count; ++i) volume.setRaw(y, x, i, rng.uniform(0, 256));
    }
  }
  Seeds seeds;
  for (int i = 0; i < 60; ++i) {  // some outside image or range, many windows overlap
    const auto draw = [&](int low, int high) { return rng.uniform(static_cast<float>(low), static_cast<float>(high)); };
    seeds.push_back(seedAt(draw(-2, size.width + 2), draw(-2, size.height + 2), draw(range.min - 2, range.max() + 2)));
  }
  CostVolume expected = volume;
  reference::propagateWindow(seeds, left, 7, 25.0, expected);
  propagateDisparity(seeds, left, windowParams(7, 25.0), volume);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int i = 0; i < range.count; ++i) ASSERT_EQ(volume.raw(y, x, i), expected.raw(y, x, i));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(RandomVolumes, PropagationReference,
                         ::testing::Combine(::testing::Range(1, 9), ::testing::Values(1, 3), ::testing::Values(8, 16)));

TEST(DisparityPropagation, NoSeedsChangeNothing) {
  const cv::Mat left(5, 6, CV_8UC1, cv::Scalar(7));
  CostVolume volume = constantVolume(left.size(), {0, 3}, CostVolume::Depth::kU8, 9);
  EXPECT_EQ(propagateDisparity({}, left, windowParams(5, 10.0), volume), 0.0);
  EXPECT_EQ(volume.raw(2, 2, 1), 9);
}

TEST(DisparityPropagation, RejectsWhatDoesNotFit) {
  const cv::Mat left(5, 6, CV_8UC1, cv::Scalar(7));
  CostVolume volume = constantVolume({5, 5}, {0, 3}, CostVolume::Depth::kU8, 9);
  EXPECT_THROW(propagateDisparity({}, left, windowParams(5, 10.0), volume), std::invalid_argument);
  volume = constantVolume(left.size(), {0, 3}, CostVolume::Depth::kU8, 9);
  EXPECT_THROW(propagateDisparity({}, left, windowParams(4, 10.0), volume), std::invalid_argument);
  EXPECT_THROW(propagateDisparity({}, left, windowParams(5, 0.0), volume), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
