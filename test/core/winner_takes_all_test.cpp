// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/winner_takes_all.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reference/instruction_sets.hpp"
#include "reference/random_images.hpp"
#include "reference/random_volume.hpp"

namespace fdp_stereo {
namespace {

OptimizerOutput winners(const CostVolume& volume, const WinnerTakesAllParams& params) {
  OptimizerOutput output;
  takeWinners(volume, params, output);
  return output;
}

WinnerTakesAllParams integers() {
  WinnerTakesAllParams params;
  params.subpixel = SubpixelFit::kNone;
  return params;
}

/// 1 x 1 x costs.size() from disparity 10 on.
CostVolume singlePixel(const std::vector<int>& costs) {
  CostVolume volume;
  volume.create(1, 1, {10, static_cast<int>(costs.size())}, CostVolume::Depth::kU8, 0.01F, 200);
  for (std::size_t i = 0; i < costs.size(); ++i) volume.setRaw(0, 0, static_cast<int>(i), costs[i]);
  volume.clearPadding();
  return volume;
}

TEST(WinnerTakesAll, HandWorkedCase) {
  WinnerTakesAllParams params;
  params.subpixel = SubpixelFit::kParabola;
  // The minimum 20 at index 2; rises 30 before and 10 after: + 0.25 px.
  EXPECT_FLOAT_EQ(winners(singlePixel({90, 50, 20, 30, 80}), params).disparity_left.at<float>(0, 0), 12.25F);
}

TEST(WinnerTakesAll, HasNoFractionAtTheEndsOfTheRange) {
  WinnerTakesAllParams params;
  params.subpixel = SubpixelFit::kParabola;
  EXPECT_FLOAT_EQ(winners(singlePixel({10, 50, 60}), params).disparity_left.at<float>(0, 0), 10.0F);
  EXPECT_FLOAT_EQ(winners(singlePixel({60, 50, 10}), params).disparity_left.at<float>(0, 0), 12.0F);
  EXPECT_FLOAT_EQ(winners(singlePixel({60}), params).disparity_left.at<float>(0, 0), 10.0F);
}

TEST(WinnerTakesAll, TiesOfNeighboursGoToTheLowerAndOthersAreNoAnswer) {
  EXPECT_FLOAT_EQ(winners(singlePixel({70, 70, 70, 40, 40}), integers()).disparity_left.at<float>(0, 0), 13.0F);
  EXPECT_TRUE(std::isnan(winners(singlePixel({70, 40, 70, 40, 40}), integers()).disparity_left.at<float>(0, 0)));
}

TEST(WinnerTakesAll, UniquenessLooksBeyondTheNeighbours) {
  WinnerTakesAllParams params = integers();
  params.uniqueness_ratio = 10.0;
  const auto kept = [&](const std::vector<int>& costs) {
    return !std::isnan(winners(singlePixel(costs), params).disparity_left.at<float>(0, 0));
  };
  EXPECT_TRUE(kept({100, 91, 90, 91, 101})) << "neighbours do not count, 100 * 0.9 is not below 90";
  EXPECT_FALSE(kept({99, 91, 90, 91, 101})) << "99 * 0.9 is below 90";
  params.uniqueness_ratio = 0.0;
  EXPECT_TRUE(kept({91, 91, 90, 91, 91}));
}

TEST(WinnerTakesAll, MarginIsTheCostOfTheSecondBestAboveTheBest) {
  EXPECT_FLOAT_EQ(winners(singlePixel({100, 90, 10, 90, 95}), integers()).margin.at<float>(0, 0), 85 * 0.01F);
  EXPECT_FLOAT_EQ(winners(singlePixel({12, 90, 10, 90, 100}), integers()).margin.at<float>(0, 0), 2 * 0.01F);
}

TEST(WinnerTakesAll, BothViewsTakeTheSmallestCost) {
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    for (const DisparityRange range : {DisparityRange{0, 1}, {0, 19}, {-7, 13}, {3, 33}, {-60, 20}}) {
      for (const auto& [rows, cols] : {std::pair{1, 13}, {6, 1}, {5, 31}}) {
        const CostVolume volume = reference::randomVolume(rows, cols, range, depth, 200, 11);
        const OptimizerOutput output = winners(volume, integers());
        for (int y = 0; y < rows; ++y) {
          for (int x = 0; x < cols; ++x) {
            int best_left = 1000;
            int best_right = 1000;
            for (int i = 0; i < range.count; ++i) {
              best_left = std::min(best_left, volume.raw(y, x, i));
              const int x_left = x + range.min + i;
              if (x_left >= 0 && x_left < cols) best_right = std::min(best_right, volume.raw(y, x_left, i));
            }
            const float left = output.disparity_left.at<float>(y, x);
            if (output.margin.at<float>(y, x) == 0.0F) {
              ASSERT_TRUE(std::isnan(left)) << "a tie";
            } else {
              ASSERT_EQ(volume.raw(y, x, static_cast<int>(left) - range.min), best_left);
            }
            const float right = output.disparity_right.at<float>(y, x);
            ASSERT_EQ(std::isnan(right), best_right == 1000) << "no left pixel points at it";
            if (best_right == 1000) continue;
            ASSERT_EQ(volume.raw(y, x + static_cast<int>(right), static_cast<int>(right) - range.min), best_right);
          }
        }
      }
    }
  }
}

using WinnerTakesAllKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(WinnerTakesAllKernel);

TEST_P(WinnerTakesAllKernel, GivesTheSameBits) {
  const CostVolume volume = reference::randomVolume(17, 41, {0, 50}, CostVolume::Depth::kU8, 250, 12);
  const auto optimized = [&] { return winners(volume, {}); };
  const OptimizerOutput actual = onThisSet(optimized);
  const OptimizerOutput expected = onBaseline(optimized);
  EXPECT_TRUE(reference::sameBits(actual.disparity_left, expected.disparity_left));
  EXPECT_TRUE(reference::sameBits(actual.disparity_right, expected.disparity_right));
  EXPECT_TRUE(reference::sameBits(actual.margin, expected.margin));
}

}  // namespace
}  // namespace fdp_stereo
