// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/semi_global.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include <omp.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/io.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"
#include "reference/random_volume.hpp"
#include "reference/semi_global_reference.hpp"

namespace fdp_stereo {
namespace {

SemiGlobalParams testParams() {
  SemiGlobalParams params;
  params.p1 = 0.1;
  params.p2 = 0.4;
  params.subpixel = SubpixelFit::kNone;
  return params;
}

OptimizerOutput optimize(const CostVolume& volume, const cv::Mat& left, const SemiGlobalParams& params) {
  cv::Mat guide = left;
  if (left.channels() == 3) cv::cvtColor(left, guide, cv::COLOR_BGR2GRAY);
  OptimizerOutput output;
  SemiGlobalMatcher().match(volume, guide, params, output);
  return output;
}

/// Random volume whose path costs fit its depth with the penalties of testParams().
CostVolume fittingVolume(int rows, int cols, DisparityRange range, CostVolume::Depth depth, unsigned seed) {
  return reference::randomVolume(rows, cols, range, depth, depth == CostVolume::Depth::kU8 ? 190 : 6000, seed);
}

/// Is there another smallest sum more than one disparity away?
bool isTied(const int* sums, int count, std::ptrdiff_t winner) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (std::abs(i - winner) > 1 && sums[i] == sums[winner]) return true;
  }
  return false;
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
  SemiGlobalParams params = testParams();
  params.p1 = 2.0;
  params.p2 = 2.0;
  const cv::Mat grey(1, 3, CV_8UC1, cv::Scalar(50));
  EXPECT_EQ(reference::pathSums(volume, grey, params), (std::vector<int>{0, 21, 16, 16, 0, 21}));
  const OptimizerOutput output = optimize(volume, grey, params);
  EXPECT_EQ(output.disparity_left.at<float>(0, 1), 0.0F) << "winner-takes-all alone would say 1";
}

TEST(SemiGlobal, WinnersHaveTheSmallestPathSums) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    for (const DisparityRange range : {DisparityRange{0, 1}, {0, 17}, {-5, 32}, {-40, 80}}) {
      for (const auto& [rows, cols] : {std::pair{1, 19}, {19, 1}, {2, 5}, {9, 23}, {37, 6}}) {
        const CostVolume volume = fittingVolume(rows, cols, range, depth, 21);
        const cv::Mat grey = reference::noise(rows, cols, CV_8UC1, 22);
        const std::vector<int> sums = reference::pathSums(volume, grey, testParams());
        const OptimizerOutput output = optimize(volume, grey, testParams());
        for (int p = 0; p < rows * cols; ++p) {
          const int* begin = &sums[static_cast<std::size_t>(p) * range.count];
          const float disparity = output.disparity_left.at<float>(p / cols, p % cols);
          const auto winner = std::min_element(begin, begin + range.count) - begin;
          ASSERT_EQ(std::isnan(disparity), isTied(begin, range.count, winner)) << "pixel " << p;
          if (std::isnan(disparity)) continue;
          ASSERT_EQ(static_cast<int>(disparity) - range.min, winner) << "pixel " << p;
        }
      }
    }
  }
}

TEST(SemiGlobal, TheRightViewReadsTheSameSums) {
  const DisparityRange range{-2, 13};
  const CostVolume volume = fittingVolume(7, 29, range, CostVolume::Depth::kU8, 31);
  const cv::Mat grey = reference::noise(7, 29, CV_8UC1, 32);
  const std::vector<int> sums = reference::pathSums(volume, grey, testParams());
  const OptimizerOutput output = optimize(volume, grey, testParams());
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

TEST(SemiGlobal, TilesThatHoldEverythingChangeNothing) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    const DisparityRange range{-3, 40};
    const CostVolume whole = fittingVolume(37, 75, range, depth, 21);
    const SearchTiles all{std::vector<SearchTiles::Span>(9, {0, 48})};
    const cv::Mat grey = reference::noise(37, 75, CV_8UC1, 22);
    SemiGlobalParams params = testParams();
    params.subpixel = SubpixelFit::kBlended;
    const OptimizerOutput expected = optimize(whole, grey, params);
    const OptimizerOutput actual = optimize(reference::searchedOf(whole, all), grey, params);
    EXPECT_TRUE(reference::sameBits(actual.disparity_left, expected.disparity_left));
    EXPECT_TRUE(reference::sameBits(actual.disparity_right, expected.disparity_right));
    EXPECT_TRUE(reference::sameBits(actual.margin, expected.margin));
  }
}

TEST(SemiGlobal, WinnersInTilesHaveTheSmallestSumsThere) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    for (const auto& [rows, cols] : {std::pair{1, 70}, {40, 3}, {37, 75}, {16, 32}}) {
      const DisparityRange range{-3, 70};
      const SearchTiles tiles = reference::randomTiles({cols, rows}, range, 5);
      const CostVolume volume = reference::searchedOf(fittingVolume(rows, cols, range, depth, 21), tiles);
      const cv::Mat grey = reference::noise(rows, cols, CV_8UC1, 22);
      const std::vector<int> sums = reference::pathSums(volume, grey, testParams());
      for (const int threads : {1, 2, 3, 8}) {
        omp_set_num_threads(threads);
        const OptimizerOutput output = optimize(volume, grey, testParams());
        for (int p = 0; p < rows * cols; ++p) {
          const int* begin = &sums[static_cast<std::size_t>(p) * range.count];
          const float disparity = output.disparity_left.at<float>(p / cols, p % cols);
          if (std::isnan(disparity)) continue;
          ASSERT_EQ(static_cast<int>(disparity) - range.min, std::min_element(begin, begin + range.count) - begin)
              << p % cols << ", " << p / cols;
        }
      }
      omp_set_num_threads(omp_get_num_procs());
    }
  }
}

using SemiGlobalKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(SemiGlobalKernel);

TEST_P(SemiGlobalKernel, GivesTheSameBits) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    const CostVolume volume = fittingVolume(31, 45, {0, 90}, depth, 41);
    const cv::Mat left = reference::noise(31, 45, CV_8UC3, 42);
    SemiGlobalParams params = testParams();
    params.subpixel = SubpixelFit::kBlended;
    const auto optimized = [&] { return optimize(volume, left, params); };
    const OptimizerOutput expected = onBaseline(optimized);
    const auto expectSame = [&](const OptimizerOutput& actual) {
      EXPECT_TRUE(reference::sameBits(actual.disparity_left, expected.disparity_left));
      EXPECT_TRUE(reference::sameBits(actual.disparity_right, expected.disparity_right));
      EXPECT_TRUE(reference::sameBits(actual.margin, expected.margin));
    };
    expectSame(onThisSet(optimized));
    for (const int threads : {1, 2, 8}) {
      omp_set_num_threads(threads);
      expectSame(optimized());
    }
  }
}

TEST(SemiGlobal, TiesAreNoAnswer) {
  CostVolume volume = fittingVolume(5, 40, {0, 16}, CostVolume::Depth::kU8, 71);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 40; ++x) {
      for (int i = 0; i < 16; ++i) volume.setRaw(y, x, i, 0);
    }
  }
  const OptimizerOutput output = optimize(volume, cv::Mat(5, 40, CV_8UC1, cv::Scalar(7)), testParams());
  EXPECT_EQ(cv::countNonZero(noneMask(output.disparity_left)), 200);
  EXPECT_EQ(cv::countNonZero(output.margin), 0);
}

TEST(SemiGlobal, RefusesAGuideOfAnotherSizeOrType) {
  const CostVolume volume = fittingVolume(3, 3, {0, 4}, CostVolume::Depth::kU8, 61);
  OptimizerOutput output;
  for (const cv::Mat& guide : {cv::Mat(3, 4, CV_8UC1), cv::Mat(3, 3, CV_8UC3), cv::Mat()}) {
    EXPECT_THROW(SemiGlobalMatcher().match(volume, guide, testParams(), output), std::invalid_argument);
  }
}

TEST(SemiGlobal, SmoothsWhatWinnerTakesAllCannot) {
  // Noise on the costs of one true disparity: with penalties the answer is the plane, without any it is the noise.
  CostVolume volume = reference::randomVolume(40, 40, {0, 20}, CostVolume::Depth::kU8, 150, 51);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) volume.setRaw(y, x, 7, volume.raw(y, x, 7) / 3);
  }
  const cv::Mat grey(40, 40, CV_8UC1, cv::Scalar(90));
  SemiGlobalParams params = testParams();
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
  SemiGlobalParams params = testParams();
  params.p2 = 3.0;
  EXPECT_THROW(optimize(volume, cv::Mat(3, 3, CV_8UC1, cv::Scalar(0)), params), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
