// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/local_expansion.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "costs/subpixel_volume.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/matching_cost.hpp"
#include "fdp_stereo/semi_global.hpp"
#include "optimizers/local_expansion/post_processing.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;
constexpr DisparityRange kRange{0, 20};

cv::Mat texture(int seed) {
  cv::Mat image(kHeight, kWidth, CV_8UC3);
  cv::RNG random(seed);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 1.2);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

/// A slanted ground with a slanted board before it.
float truthAt(int x, int y) {
  const bool board = x >= 40 && x < 70 && y >= 20 && y < 50;
  const float fx = static_cast<float>(x);
  const float fy = static_cast<float>(y);
  return board ? 11.0F + 0.06F * (fx - 40.0F) : 3.0F + 0.05F * fy;
}

struct Scene {
  StereoPair pair;
  cv::Mat truth;
  CostVolume volume;
  MatchingCostParams cost;
  CostScale scale;
  Seeds seeds;
  OptimizerOutput initial;

  explicit Scene(int seed = 1) : truth(kHeight, kWidth, CV_32FC1) {
    pair.right = texture(seed);
    cv::Mat map_x(kHeight, kWidth, CV_32FC1);
    cv::Mat map_y(kHeight, kWidth, CV_32FC1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        truth.at<float>(y, x) = truthAt(x, y);
        map_x.at<float>(y, x) = static_cast<float>(x) - truthAt(x, y);
        map_y.at<float>(y, x) = static_cast<float>(y);
      }
    }
    cv::remap(pair.right, pair.left, map_x, map_y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    cv::cvtColor(pair.left, pair.left_grey, cv::COLOR_BGR2GRAY);
    cv::cvtColor(pair.right, pair.right_grey, cv::COLOR_BGR2GRAY);
    cost.census = {5, 5};
    scale = fitCostScale(maxMatchingCost(cost), penaltiesOf(SemiGlobalParams{}));
    computeMatchingCost(pair, kRange, cost, scale, volume);
  }

  LocalExpansionInput input() const {
    const auto finer_costs = [this](ExpandedView side, int steps, CostVolume& finer) {
      computeSubpixelVolume(side == ExpandedView::kLeft ? pair : mirrorPair(pair), volume.range(), cost, steps, finer);
    };
    return {volume, pair, seeds, initial, finer_costs, nullptr, {}};
  }
  void start() { SemiGlobalMatcher().match(volume, pair.left_grey, SemiGlobalParams{}, initial); }
};

LocalExpansionParams testParams() {
  LocalExpansionParams params;
  params.data_scale = 0.5;
  params.filter_radius_px = 4;
  params.margin_px = 2;
  params.fine_cell = 5.0;
  params.middle_cell = 12.0;
  params.coarse_cell = 30.0;
  params.iterations = 2;
  params.right_iterations = 2;
  return params;
}

/// From the disparities of semi-global matching, or from nothing.
OptimizerOutput run(Scene scene, const LocalExpansionParams& params) {
  if (params.initialization == PlaneInitialization::kSemiGlobal) scene.start();
  OptimizerOutput output;
  expandLocally(scene.input(), params, output);
  return output;
}

/// Share of pixels seen by both cameras that are off by more than `limit`.
double badShare(const Scene& scene, const cv::Mat& disparity, float limit) {
  int bad = 0;
  int count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 16; x < kWidth; ++x) {
      if (x >= 28 && x < 42) continue;  // hidden by the board in the right view
      ++count;
      bad += std::fabs(disparity.at<float>(y, x) - scene.truth.at<float>(y, x)) > limit ? 1 : 0;
    }
  }
  return static_cast<double>(bad) / count;
}

TEST(LocalExpansion, FindsSlantedPlanes) {
  const Scene scene;
  const OptimizerOutput output = run(scene, testParams());
  EXPECT_LT(badShare(scene, output.disparity_left, 0.5F), 0.04);
  EXPECT_EQ(output.disparity_right.size(), output.disparity_left.size());
  EXPECT_TRUE(cv::checkRange(output.disparity_left)) << "NaN or infinite";
}

TEST(LocalExpansion, CostsBetweenPixelsAreMorePrecise) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  params.disparity_steps = 4;
  const double fine = badShare(scene, run(scene, params).disparity_left, 0.125F);
  params.disparity_steps = 1;
  EXPECT_LT(fine, badShare(scene, run(scene, params).disparity_left, 0.125F));
  EXPECT_LT(fine, 0.1);
}

TEST(LocalExpansion, EnergyNeverRises) {
  const Scene scene;
  for (const PlaneInitialization initialization : {PlaneInitialization::kRandom, PlaneInitialization::kSemiGlobal}) {
    LocalExpansionParams params = testParams();
    params.initialization = initialization;
    params.iterations = 4;
    const std::vector<double> energies = run(scene, params).energies;
    ASSERT_EQ(energies.size(), 5U);
    for (std::size_t i = 1; i < energies.size(); ++i) EXPECT_LE(energies[i], energies[i - 1] + 1e-6 * energies[0]);
    EXPECT_LT(energies[4], energies[0]);
  }
}

TEST(LocalExpansion, ViewsHaveRoundsOfTheirOwn) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  params.right_iterations = 0;
  const OptimizerOutput without = run(scene, params);
  params.right_iterations = 1;
  const OptimizerOutput with = run(scene, params);
  EXPECT_EQ(with.energies, without.energies) << "those of the left view";
  EXPECT_GT(cv::norm(with.disparity_right, without.disparity_right, cv::NORM_INF), 0.0);
}

TEST(LocalExpansion, RandomStartReachesTheEnergyOfTheSemiGlobalStart) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  params.iterations = 4;
  const double informed = run(scene, params).energies.back();
  params.initialization = PlaneInitialization::kRandom;
  params.unary_iterations = 2;
  params.fine.random = 7;
  params.random_first_step = 0;
  EXPECT_NEAR(run(scene, params).energies.back(), informed, 0.02 * informed);
}

TEST(LocalExpansion, SameBitsForAnyNumberOfThreads) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  params.disparity_steps = 2;
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const OptimizerOutput one = run(scene, params);
  for (const int threads : {2, 4}) {
    omp_set_num_threads(threads);
    const OptimizerOutput many = run(scene, params);
    EXPECT_TRUE(reference::sameBits(one.disparity_left, many.disparity_left)) << threads;
    EXPECT_TRUE(reference::sameBits(one.disparity_right, many.disparity_right)) << threads;
    EXPECT_TRUE(reference::sameBits(one.margin, many.margin)) << threads;
    EXPECT_EQ(one.energies, many.energies) << threads;
  }
  omp_set_num_threads(before);
}

TEST(LocalExpansion, SeedChangesTheNumbersNotTheAnswer) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  const OptimizerOutput one = run(scene, params);
  params.seed = 7;
  const OptimizerOutput other = run(scene, params);
  EXPECT_FALSE(reference::sameBits(one.disparity_left, other.disparity_left));
  EXPECT_NEAR(one.energies.back(), other.energies.back(), 0.01 * one.energies.back());
}

TEST(LocalExpansion, CancelledRunReturnsTheInitialPlanes) {
  Scene scene;
  scene.start();
  const std::atomic<bool> cancel{true};
  LocalExpansionInput input = scene.input();
  input.cancel = &cancel;
  OptimizerOutput output;
  expandLocally(input, testParams(), output);
  EXPECT_EQ(output.energies.size(), 1U);
  EXPECT_LT(badShare(scene, output.disparity_left, 1.0F), 0.1);
}

TEST(LocalExpansion, OutOfTimeIsLikeCancelled) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  params.iterations = 100;
  params.max_time_ms = 1.0;
  const OptimizerOutput output = run(scene, params);
  EXPECT_LT(output.energies.size(), 100U);
  EXPECT_EQ(output.disparity_left.size(), cv::Size(kWidth, kHeight));
}

TEST(LocalExpansion, ReportsEveryRoundOfBothViews) {
  const Scene scene;
  LocalExpansionInput input = scene.input();
  std::vector<int> done;
  int all = 0;
  input.progress = [&](int step, int steps, double energy) {
    done.push_back(step);
    all = steps;
    EXPECT_GT(energy, 0.0);
  };
  OptimizerOutput output;
  expandLocally(input, testParams(), output);
  EXPECT_EQ(done, (std::vector<int>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(all, 6);
}

TEST(LocalExpansion, StopsWhenARoundGainsLittle) {
  const Scene scene;
  LocalExpansionParams params = testParams();
  params.iterations = 10;
  params.stop_gain = 5.0;
  EXPECT_LT(run(scene, params).energies.size(), 8U);
}

TEST(LocalExpansion, MirroredAndExchangedImagesExchangeTheViews) {
  const Scene scene;
  Scene other;
  other.pair = mirrorPair(scene.pair);
  computeMatchingCost(other.pair, kRange, other.cost, scene.scale, other.volume);
  const OptimizerOutput a = run(scene, testParams());
  const OptimizerOutput b = run(other, testParams());
  cv::Mat mirrored;
  cv::flip(b.disparity_right, mirrored, 1);
  int different = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 16; x < kWidth; ++x) {
      if (x >= 28 && x < 42) continue;
      different += std::fabs(mirrored.at<float>(y, x) - a.disparity_left.at<float>(y, x)) > 0.5F ? 1 : 0;
    }
  }
  EXPECT_LT(different, kHeight * kWidth / 40);
}

TEST(LocalExpansion, SmallAndDegenerateInput) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(9, 1), cv::Size(3, 14)}) {
    for (const DisparityRange range : {DisparityRange{0, 1}, DisparityRange{-2, 30}}) {
      Scene scene;
      scene.pair.left = cv::Mat(size, CV_8UC3, cv::Scalar(90, 90, 90));
      scene.pair.right = scene.pair.left.clone();
      scene.pair.left_grey = cv::Mat(size, CV_8UC1, cv::Scalar(90));
      scene.pair.right_grey = scene.pair.left_grey.clone();
      computeMatchingCost(scene.pair, range, scene.cost, scene.scale, scene.volume);
      for (const int steps : {1, 3}) {
        LocalExpansionParams params = testParams();
        params.disparity_steps = steps;
        const OptimizerOutput output = run(scene, params);
        EXPECT_EQ(output.disparity_left.size(), size);
        for (int i = 0; i < size.area(); ++i) EXPECT_TRUE(range.contains(output.disparity_left.at<float>(i)));
      }
    }
  }
}

TEST(LocalExpansion, WrongInputIsRefused) {
  Scene scene;
  LocalExpansionParams params = testParams();
  params.disparity_steps = 2;
  OptimizerOutput output;
  LocalExpansionInput input = scene.input();
  input.finer_costs = nullptr;
  EXPECT_THROW(expandLocally(input, params, output), std::invalid_argument);
  scene.pair.left = cv::Mat(3, 3, CV_8UC3, cv::Scalar(0, 0, 0));
  EXPECT_THROW(expandLocally(scene.input(), testParams(), output), std::invalid_argument);
}

TEST(SubpixelVolume, WholeDisparitiesAreTheMatchingCost) {
  const Scene scene;
  CostVolume fine;
  CostVolume whole;
  computeSubpixelVolume(scene.pair, kRange, scene.cost, 3, fine);
  computeMatchingCost(scene.pair, kRange, scene.cost, {fine.depth(), fine.step()}, whole);
  ASSERT_EQ(fine.range().count, 3 * (kRange.count - 1) + 1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int i = 0; i < kRange.count; ++i) ASSERT_EQ(fine.raw(y, x, 3 * i), whole.raw(y, x, i));
    }
  }
}

TEST(SubpixelVolume, TheMinimumLiesBetweenThePixels) {
  // The left image is the right one moved by 4.5 px: entry 9 of steps of a half must be the cheapest nearly everywhere.
  Scene scene;
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1.0, 0.0, -4.5, 0.0, 1.0, 0.0);
  cv::warpAffine(scene.pair.right, scene.pair.left, move, scene.pair.right.size(),
                 cv::INTER_LANCZOS4 | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  cv::cvtColor(scene.pair.left, scene.pair.left_grey, cv::COLOR_BGR2GRAY);
  CostVolume fine;
  computeSubpixelVolume(scene.pair, kRange, scene.cost, 2, fine);
  int right = 0;
  int count = 0;
  for (int y = 4; y < kHeight - 4; ++y) {
    for (int x = 24; x < kWidth - 8; ++x, ++count) {
      int best = 0;
      for (int i = 1; i < fine.range().count; ++i) {
        if (fine.raw(y, x, i) < fine.raw(y, x, best)) best = i;
      }
      right += best == 9 ? 1 : 0;
    }
  }
  EXPECT_GT(right, count * 95 / 100);
}

TEST(SubpixelVolume, MirroredVolumeIsThatOfTheRightView) {
  const Scene scene;
  CostVolume mirrored;
  mirrorVolume(scene.volume, mirrored);
  for (int y = 0; y < kHeight; y += 5) {
    for (int x = 0; x < kWidth - kRange.count; ++x) {
      for (int d = 0; d < kRange.count; ++d) {
        ASSERT_EQ(mirrored.raw(y, kWidth - 1 - x, d), scene.volume.raw(y, x + d, d));
      }
    }
  }
}

TEST(PlanePostProcessing, FillsFromTheBackgroundAndKeepsConsistentPixels) {
  local_expansion::Labels labels;
  labels.create({12, 3});
  cv::Mat consistent(3, 12, CV_8UC1, cv::Scalar(255));
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 12; ++x) labels.planes.set(labels.index(x, y), {0.0F, 0.0F, x < 5 ? 2.0F : 8.0F});
    for (int x = 5; x < 7; ++x) consistent.at<std::uint8_t>(y, x) = 0;
  }
  local_expansion::fillPlanes(consistent, labels);
  for (int x = 0; x < 12; ++x) EXPECT_EQ(labels.disparity(x, 1), x < 7 ? 2.0F : 8.0F) << x;
}

TEST(PlanePostProcessing, ConsistentMeansBothViewsAgree) {
  local_expansion::Labels left;
  local_expansion::Labels right;  // mirrored
  left.create({10, 1});
  right.create({10, 1});
  for (int x = 0; x < 10; ++x) {
    left.planes.set(left.index(x, 0), {0.0F, 0.0F, 3.0F});
    right.planes.set(right.index(x, 0), {0.0F, 0.0F, x < 5 ? 3.0F : 5.0F});  // right pixels 9..5: 3 px, 4..0: 5 px
  }
  const cv::Mat consistent = local_expansion::consistentPixels(left, right, 1.5);
  for (int x = 0; x < 10; ++x) EXPECT_EQ(consistent.at<std::uint8_t>(0, x) != 0, x >= 8) << x;
}

TEST(PlanePostProcessing, MedianReplacesInconsistentPixelsOnly) {
  cv::Mat image(9, 9, CV_8UC1, cv::Scalar(100));
  local_expansion::Labels labels;
  labels.create({9, 9});
  for (std::size_t i = 0; i < 81; ++i) labels.planes.set(i, {0.0F, 0.0F, 4.0F});
  labels.planes.set(labels.index(4, 4), {0.0F, 0.0F, 9.0F});
  labels.planes.set(labels.index(2, 2), {0.0F, 0.0F, 9.0F});
  cv::Mat consistent(9, 9, CV_8UC1, cv::Scalar(255));
  consistent.at<std::uint8_t>(4, 4) = 0;
  local_expansion::filterPlanes(image, consistent, 2, 10.0, labels);
  EXPECT_EQ(labels.disparity(4, 4), 4.0F);
  EXPECT_EQ(labels.disparity(2, 2), 9.0F);
}

}  // namespace
}  // namespace fdp_stereo
