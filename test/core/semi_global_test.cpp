// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/semi_global.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "fdp_stereo/matching_cost.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"
#include "reference/random_volume.hpp"
#include "reference/semi_global_reference.hpp"

namespace fdp_stereo {
namespace {

SemiGlobalParams paramsOf(int paths) {
  SemiGlobalParams params;
  params.paths = paths;
  params.p1 = 0.1;
  params.p2 = 0.4;
  params.subpixel = SubpixelFit::kNone;
  return params;
}

OptimizerOutput optimize(const CostVolume& volume, const cv::Mat& left, const SemiGlobalParams& params) {
  StereoPair pair;
  pair.left = left;
  const Seeds seeds;
  OptimizerOutput output;
  SemiGlobal(params).optimize({volume, pair, seeds, nullptr, nullptr, nullptr, {}}, output);
  return output;
}

/// Random volume whose path costs fit its depth with the penalties of paramsOf().
CostVolume fittingVolume(int rows, int cols, DisparityRange range, CostVolume::Depth depth, unsigned seed) {
  return reference::randomVolume(rows, cols, range, depth, depth == CostVolume::Depth::kU8 ? 190 : 6000, seed);
}

TEST(SemiGlobal, HandWorkedCase) {
  // One row of three pixels, two disparities, P1 = P2 = 2 units, costs (0 5) (4 3) (0 5). From the left:
  //   L(0) = 0 5,  L(1) = 4 + 0, 3 + min(5, 0 + 2) = 4 5,  L(2) = 0 + 4 - 4, 5 + min(5, 4 + 2) - 4 = 0 6;
  // from the right the same mirrored. The two vertical paths hold the cost itself. Sums: 0 21, 16 16, 0 21.
  CostVolume volume;
  volume.create(1, 3, {0, 2}, CostVolume::Depth::kU8, 1.0F, 10);
  const int costs[3][2] = {{0, 5}, {4, 3}, {0, 5}};
  for (int x = 0; x < 3; ++x) {
    for (int i = 0; i < 2; ++i) volume.setRaw(0, x, i, costs[x][i]);
  }
  volume.clearPadding();
  SemiGlobalParams params = paramsOf(4);
  params.p1 = 2.0;
  params.p2 = 2.0;
  const cv::Mat grey(1, 3, CV_8UC1, cv::Scalar(50));
  EXPECT_EQ(reference::pathSums(volume, grey, params), (std::vector<int>{0, 21, 16, 16, 0, 21}));
  const OptimizerOutput output = optimize(volume, grey, params);
  EXPECT_EQ(output.disparity_left.at<float>(0, 1), 0.0F) << "winner-takes-all alone would say 1";
}

TEST(SemiGlobal, WinnersHaveTheSmallestPathSums) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    for (const int paths : {4, 8}) {
      for (const DisparityRange range : {DisparityRange{0, 1}, {0, 17}, {-5, 32}, {-40, 21}}) {
        for (const auto& [rows, cols] : {std::pair{1, 19}, {19, 1}, {2, 5}, {9, 23}}) {
          const CostVolume volume = fittingVolume(rows, cols, range, depth, 21);
          const cv::Mat grey = reference::noise(rows, cols, CV_8UC1, 22);
          const std::vector<int> sums = reference::pathSums(volume, grey, paramsOf(paths));
          const OptimizerOutput output = optimize(volume, grey, paramsOf(paths));
          for (int p = 0; p < rows * cols; ++p) {
            const int* begin = &sums[static_cast<std::size_t>(p) * range.count];
            const int winner = static_cast<int>(output.disparity_left.at<float>(p / cols, p % cols)) - range.min;
            ASSERT_EQ(winner, std::min_element(begin, begin + range.count) - begin) << "pixel " << p;
          }
        }
      }
    }
  }
}

TEST(SemiGlobal, TheRightViewReadsTheSameSums) {
  const DisparityRange range{-2, 13};
  const CostVolume volume = fittingVolume(7, 29, range, CostVolume::Depth::kU8, 31);
  const cv::Mat grey = reference::noise(7, 29, CV_8UC1, 32);
  const std::vector<int> sums = reference::pathSums(volume, grey, paramsOf(8));
  const OptimizerOutput output = optimize(volume, grey, paramsOf(8));
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 29; ++x) {
      const auto sum = [&](int i) {
        const int x_left = x + range.min + i;
        return x_left < 0 || x_left >= 29 ? 1 << 20
                                          : sums[(static_cast<std::size_t>(y) * 29 + x_left) * range.count + i];
      };
      int smallest = 1 << 20;
      for (int i = 0; i < range.count; ++i) smallest = std::min(smallest, sum(i));
      const float right = output.disparity_right.at<float>(y, x);
      ASSERT_FALSE(std::isnan(right));
      ASSERT_EQ(sum(static_cast<int>(right) - range.min), smallest);
    }
  }
}

using SemiGlobalKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(SemiGlobalKernel);

TEST_P(SemiGlobalKernel, GivesTheSameBits) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    const CostVolume volume = fittingVolume(31, 45, {0, 37}, depth, 41);
    const cv::Mat left = reference::noise(31, 45, CV_8UC3, 42);
    SemiGlobalParams params = paramsOf(8);
    params.subpixel = SubpixelFit::kBlended;
    const auto optimized = [&] { return optimize(volume, left, params); };
    const OptimizerOutput actual = onThisSet(optimized);
    const OptimizerOutput expected = onBaseline(optimized);
    EXPECT_EQ(reference::differingPixels(actual.disparity_left, expected.disparity_left), 0);
    EXPECT_EQ(reference::differingPixels(actual.disparity_right, expected.disparity_right), 0);
    EXPECT_EQ(reference::differingPixels(actual.confidence, expected.confidence), 0);
  }
}

TEST(SemiGlobal, SmoothsWhatWinnerTakesAllCannot) {
  // Noise on the costs of one true disparity: with penalties the answer is the plane, without any it is the noise.
  CostVolume volume = reference::randomVolume(40, 40, {0, 20}, CostVolume::Depth::kU8, 150, 51);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) volume.setRaw(y, x, 7, volume.raw(y, x, 7) / 3);
  }
  const cv::Mat grey(40, 40, CV_8UC1, cv::Scalar(90));
  SemiGlobalParams params = paramsOf(8);
  params.p1 = 0.3;
  params.p2 = 0.8;
  const auto right = [](const cv::Mat& disparity) { return cv::countNonZero(disparity == 7.0F) / 1600.0; };
  EXPECT_GT(right(optimize(volume, grey, params).disparity_left), 0.75);
  params.p1 = 0.0;
  params.p2 = 0.0;
  EXPECT_LT(right(optimize(volume, grey, params).disparity_left), 0.5);
}

TEST(SemiGlobal, RefusesPenaltiesThatDoNotFit) {
  const CostVolume volume = fittingVolume(3, 3, {0, 4}, CostVolume::Depth::kU8, 61);
  SemiGlobalParams params = paramsOf(8);
  params.p2 = 3.0;
  EXPECT_THROW(optimize(volume, cv::Mat(3, 3, CV_8UC1, cv::Scalar(0)), params), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
