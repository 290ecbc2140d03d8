// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seeds/search_tiles.hpp"

#include <gtest/gtest.h>

#include "fdp_stereo/pipeline.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr DisparityRange kRange{-8, 200};
constexpr int kRowStep = 4;
const cv::Size kImage(170, 70);  // tiles: 6 x 5

/// A wall at 20 px, found in every row that was matched.
RoughDisparity wall() {
  const cv::Mat found(17, kImage.width, CV_32FC1, cv::Scalar(20.0F));
  return {found.clone(), found.clone()};
}

SearchTiles tilesOf(const RoughDisparity& rough, const Seeds& seeds = {}) {
  return findSearchTiles(rough, seeds, kImage, kRange, kRowStep);
}

bool searches(const SearchTiles& tiles, int row, int column, int d) {
  const SearchTiles::Span span = tiles.spans[static_cast<std::size_t>(row) * 6 + column];
  return d - kRange.min >= span.first && d - kRange.min < span.first + span.count;
}

TEST(SearchTiles, HoldWhatWasFoundAndALittleMore) {
  const SearchTiles tiles = tilesOf(wall());
  ASSERT_EQ(tiles.spans.size(), 30U);
  for (const SearchTiles::Span& span : tiles.spans) {
    EXPECT_EQ(span.count, 16);
    EXPECT_LE(span.first, 28 - 2);
    EXPECT_GT(span.first + span.count, 28 + 2);
  }
}

TEST(SearchTiles, AThinThingThatASeedKnowsIsSearchedAroundIt) {
  Seed seed;
  seed.x = 70.0F;
  seed.y = 35.0F;
  seed.d = 140.0F;
  const SearchTiles tiles = tilesOf(wall(), {seed});
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_EQ(searches(tiles, row, column, 140), std::abs(row - 2) <= 1 && std::abs(column - 2) <= 1);
      EXPECT_TRUE(searches(tiles, row, column, 20));
    }
  }
}

TEST(SearchTiles, WinnersCountWhereSeveralAgree) {
  RoughDisparity rough = wall();
  for (int row = 0; row < 4; ++row) {
    rough.winners.at<float>(row, 10) = static_cast<float>(90 + row % 2);  // 4 that differ by 1 px
    rough.winners.at<float>(row, 40) = static_cast<float>(90 + 9 * row);  // 4 that do not agree
  }
  const SearchTiles tiles = tilesOf(rough);
  EXPECT_TRUE(searches(tiles, 0, 0, 90));
  EXPECT_FALSE(searches(tiles, 0, 1, 90));
  EXPECT_FALSE(searches(tiles, 1, 0, 90));
}

TEST(SearchTiles, AreNotWorthWhileWhereMostMustBeSearched) {
  RoughDisparity rough = wall();
  rough.winners.setTo(kInvalidDisparity);
  rough.known.setTo(kInvalidDisparity);
  EXPECT_TRUE(tilesOf(rough).spans.empty()) << "nothing found: everything is searched";
  rough.known.setTo(-8.0F);
  rough.known.colRange(0, 1).setTo(191.0F);
  rough.known.colRange(100, 101).setTo(191.0F);
  EXPECT_TRUE(tilesOf(rough).spans.empty());
}

TEST(SearchTiles, BordersOfTheRangeArePartOfIt) {
  RoughDisparity rough = wall();
  for (const float d : {-8.0F, 191.0F}) {
    rough.winners.setTo(d);
    rough.known.setTo(d);
    const SearchTiles tiles = tilesOf(rough);
    EXPECT_TRUE(searches(tiles, 0, 0, static_cast<int>(d)));
    EXPECT_GE(tiles.spans[0].first, 0);
    EXPECT_LE(tiles.spans[0].first + tiles.spans[0].count, kRange.count);
  }
}

class PipelineOfTiles : public reference::EveryInstructionSet {
 protected:
  static PipelineResult run(const reference::RenderedPair& pair, int threads) {
    PipelineParams params = loadPreset("fast");
    params.search = {0, 128};
    params.threads = threads;
    return Pipeline(params).run(pair.left, pair.right);
  }
};
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(PipelineOfTiles);

TEST_P(PipelineOfTiles, FindsBothSurfacesWithTheSameBits) {
  const reference::RenderedPair pair = reference::renderPair(120, 360, 20, 70, 5);
  const PipelineResult expected = onBaseline([&] { return run(pair, 1); });
  EXPECT_LT(cv::countNonZero((cv::abs(expected.disparity - pair.truth) > 1.0F) & pair.visible),
            cv::countNonZero(pair.visible) / 50);
  for (const int threads : {1, 2, 3, 8}) {
    const PipelineResult actual = onThisSet([&] { return run(pair, threads); });
    EXPECT_TRUE(reference::sameBits(actual.disparity, expected.disparity)) << threads << " threads";
    EXPECT_TRUE(reference::sameBits(actual.confidence, expected.confidence)) << threads << " threads";
  }
}

}  // namespace
}  // namespace fdp_stereo
