// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/quasi_dense.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "evaluation/evaluation.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"
#include "reference/random_volume.hpp"
#include "row_grid.hpp"

namespace fdp_stereo {
namespace {

constexpr DisparityRange kRange{0, 32};

SemiGlobalParams penalties() {
  SemiGlobalParams params;
  params.p1 = 0.1;
  params.p2 = 0.4;
  return params;
}

/// The rows that match() takes, as an image or volume of their own.
cv::Mat rowsOf(const cv::Mat& image, int step) {
  cv::Mat rows;
  for (int y = RowGrid(image.rows, step).first; y < image.rows; y += step) rows.push_back(image.row(y));
  return rows;
}

CostVolume rowsOf(const CostVolume& volume, int rows, int step) {
  CostVolume result;
  result.create(rows, volume.width(), volume.range(), volume.depth(), volume.step(), volume.maxRaw());
  result.clearPadding();
  const int first = RowGrid(volume.height(), step).first;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < volume.width(); ++x) {
      for (int i = 0; i < volume.range().count; ++i) result.setRaw(y, x, i, volume.raw(first + y * step, x, i));
    }
  }
  return result;
}

class Rows : public testing::TestWithParam<std::tuple<int, int>> {};
INSTANTIATE_TEST_SUITE_P(HeightsAndSteps, Rows,
                         testing::Combine(testing::Values(1, 2, 5, 24), testing::Values(1, 3, 4, 16)));

TEST_P(Rows, AreMatchedAsIfThereWereNoOthers) {
  const auto [height, step] = GetParam();
  const CostVolume volume = reference::randomVolume(height, 37, {0, 20}, CostVolume::Depth::kU8, 190, 3);
  const cv::Mat guide = reference::texture(height, 37, CV_8UC1, 4);
  OptimizerOutput actual;
  SemiGlobalMatcher().match(volume, guide, penalties(), actual, step);

  const cv::Mat fewer = rowsOf(guide, step);
  const CostVolume part = rowsOf(volume, fewer.rows, step);
  OptimizerOutput expected;
  SemiGlobalMatcher().match(part, fewer, penalties(), expected);
  ASSERT_EQ(actual.disparity_left.size(), expected.disparity_left.size());
  EXPECT_EQ(reference::differingPixels(actual.disparity_left, expected.disparity_left), 0);
  EXPECT_EQ(reference::differingPixels(actual.disparity_right, expected.disparity_right), 0);
}

PipelineParams fastParams() {
  PipelineParams params = loadPreset("fast");
  params.search = kRange;
  return params;
}

TEST(QuasiDense, SeedsAreRightAndLieOnTheirGrid) {
  const reference::RenderedPair pair = reference::renderPair(120, 200, 6, 15, 5);
  const PipelineParams params = fastParams();
  const PipelineResult result = Pipeline(params).run(pair.left, pair.right);
  const Seeds& seeds = result.quasi_dense_seeds;
  ASSERT_GT(seeds.size(), 300U);
  int wrong = 0;
  for (const Seed& seed : seeds) {
    EXPECT_EQ(seed.source, SeedSource::kQuasiDense);
    EXPECT_EQ(static_cast<int>(seed.x) % params.quasi_dense.spacing_px, params.quasi_dense.spacing_px / 2);
    wrong += std::abs(seed.d - pair.truth.at<float>(cvRound(seed.y), cvRound(seed.x))) > 1.0F ? 1 : 0;
  }
  EXPECT_LT(wrong, static_cast<int>(seeds.size()) / 50);
  EXPECT_TRUE(std::is_sorted(seeds.begin(), seeds.end(),
                             [](const Seed& a, const Seed& b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); }));
  EXPECT_GT(result.propagated_share, 0.9);
}

TEST(QuasiDense, EachSourceOfSeedsHasItsSwitch) {
  const reference::RenderedPair pair = reference::renderPair(60, 100, 6, 15, 5);
  PipelineParams params = fastParams();
  EXPECT_TRUE(Pipeline(params).run(pair.left, pair.right).seeds.empty());
  params.sparse_disparity.features = true;
  params.quasi_dense.enabled = false;
  EXPECT_FALSE(Pipeline(params).run(pair.left, pair.right).seeds.empty());
  EXPECT_TRUE(Pipeline(params).run(pair.left, pair.right).quasi_dense_seeds.empty());
}

/// A slanted wall, its disparity growing by 0.1 px per column, bare but for four strips of texture.
struct SlantedWall {
  cv::Mat left, right, truth;
};

SlantedWall slantedWall() {
  const int rows = 90, cols = 160;
  const auto disparity = [](float x) { return 4.0F + 0.1F * x; };
  cv::Mat wall = reference::texture(rows, cols, CV_8UC1, 7);
  for (const int x : {20, 60, 100}) wall.colRange(x, x + 30).setTo(120);
  SlantedWall result;
  result.left = wall;
  result.truth.create(rows, cols, CV_32FC1);
  cv::Mat map_x(rows, cols, CV_32FC1), map_y(rows, cols, CV_32FC1);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      result.truth.at<float>(y, x) = disparity(static_cast<float>(x));
      // x = u - d(u), so u = (x + 4) / 0.9.
      map_x.at<float>(y, x) = (static_cast<float>(x) + 4.0F) / 0.9F;
      map_y.at<float>(y, x) = static_cast<float>(y);
    }
  }
  cv::remap(wall, result.right, map_x, map_y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return result;
}

double badOne(const SlantedWall& wall, const PipelineParams& params) {
  const PipelineResult result = Pipeline(params).run(wall.left, wall.right);
  cv::Mat scored(wall.truth.size(), CV_8UC1, cv::Scalar(255));
  scored.colRange(0, 20).setTo(0);  // not in the right image
  return evaluateDisparity(result.disparity, wall.truth, scored).bad[3];
}

TEST(QuasiDense, CarriesASlantOverAPlaceWithoutTexture) {
  const SlantedWall wall = slantedWall();
  PipelineParams params = fastParams();
  params.hole_filling.enabled = true;
  const double with = badOne(wall, params);
  params.quasi_dense.enabled = false;
  const double without = badOne(wall, params);
  EXPECT_LT(with, 0.7 * without) << with << " % with, " << without << " % without";
}

// Without texture, from random planes and without proposals from the seeds, nothing but the seeds in the optimiser's
// own costs at quarter pixels can lead it, in the mirrored right view too: filled pixels would have no confidence.
TEST(QuasiDense, LocalExpansionSpreadsSeedsInItsOwnVolumes) {
  const cv::Mat blank(48, 80, CV_8UC1, cv::Scalar(120));
  PipelineParams params = loadPreset("accurate");
  params.search = {0, 16};
  params.local_expansion.initialization = PlaneInitialization::kRandom;
  params.local_expansion.seed_proposals = false;
  Seeds seeds;
  for (int y = 4; y < 48; y += 8) {
    for (int x = 12; x < 80; x += 8) {
      seeds.push_back({static_cast<float>(x), static_cast<float>(y), 6.5F, 1.0F, SeedSource::kPoints});
    }
  }
  const cv::Rect seen(14, 4, 62, 40);
  const PipelineResult result = Pipeline(params).run(blank, blank, seeds);
  const cv::Mat off = cv::abs(result.disparity(seen) - 6.5F) > 0.5F;
  EXPECT_LT(cv::countNonZero(off), seen.area() / 20);
  EXPECT_GT(cv::countNonZero(result.confidence(seen) > 0.0F), seen.area() * 9 / 10);
  const PipelineResult without = Pipeline(params).run(blank, blank);
  EXPECT_LT(cv::countNonZero(cv::abs(without.disparity(seen) - 6.5F) < 0.5F), seen.area() / 2);
}

TEST(QuasiDense, ThreadsGiveTheSameBits) {
  const reference::RenderedPair pair = reference::renderPair(90, 140, 6, 15, 5);
  PipelineParams params = fastParams();
  params.threads = 1;
  const PipelineResult expected = Pipeline(params).run(pair.left, pair.right);
  for (const int threads : {2, 4}) {
    params.threads = threads;
    const PipelineResult actual = Pipeline(params).run(pair.left, pair.right);
    ASSERT_EQ(actual.quasi_dense_seeds.size(), expected.quasi_dense_seeds.size());
    for (std::size_t i = 0; i < expected.quasi_dense_seeds.size(); ++i) {
      EXPECT_EQ(actual.quasi_dense_seeds[i].d, expected.quasi_dense_seeds[i].d);
    }
  }
}

TEST(QuasiDense, TakesAnySizeAndEveryOptimizer) {
  for (const auto type : {OptimizerType::kWinnerTakesAll, OptimizerType::kSemiGlobal, OptimizerType::kLocalExpansion}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(40, 1), cv::Size(1, 40), cv::Size(33, 17)}) {
      PipelineParams params = fastParams();
      params.optimizer = type;
      params.local_expansion.iterations = 1;
      params.quasi_dense.row_step = 16;
      params.quasi_dense.spacing_px = 64;
      const cv::Mat image = reference::texture(size.height, size.width, CV_8UC1, 2);
      EXPECT_EQ(Pipeline(params).run(image, image).disparity.size(), size);
    }
  }
}

}  // namespace
}  // namespace fdp_stereo
