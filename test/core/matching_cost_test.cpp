// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/matching_cost.hpp"

#include <gtest/gtest.h>

#include "reference/instruction_sets.hpp"
#include "reference/matching_cost_reference.hpp"
#include "reference/random_images.hpp"
#include "reference/random_volume.hpp"

namespace fdp_stereo {
namespace {

// Colours, slopes and weights are kept in 1/32 grey level and 1/64 bit or so: up to five roundings of the first, at a
// slope of theta of at most 1/10 per grey level.
constexpr double kTolerance = 0.02;
// The integer theta of 8-bit volumes.
constexpr double kThetaError = 6e-4;

MatchingCostParams paramsOf(MatchingCostType type, int scales = 1) {
  MatchingCostParams params;
  params.type = type;
  params.census = {9, 7};
  params.alpha = 0.8;
  params.lambda_rho = 10.0;
  params.lambda_census = 30.0;
  params.rho_weight = 1.0;
  params.scales = scales;
  return params;
}

CostScale scaleOf(const MatchingCostParams& params, int bits = 16) {
  const auto step = static_cast<float>(maxMatchingCost(params) / (bits == 8 ? 200.0 : 4000.0));
  return {bits == 8 ? CostVolume::Depth::kU8 : CostVolume::Depth::kU16, step};
}

CostVolume volumeOf(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params, int bits = 16) {
  CostVolume volume;
  computeMatchingCost(pair, range, params, scaleOf(params, bits), volume);
  return volume;
}

void expectEqual(const CostVolume& a, const CostVolume& b) {
  ASSERT_EQ(a.bytes(), b.bytes());
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      for (int i = 0; i < a.span(y, x).count; ++i)
        ASSERT_EQ(a.raw(y, x, i), b.raw(y, x, i)) << x << ", " << y << ", " << i;
    }
  }
}

TEST(MatchingCost, OfSearchTilesIsThatOfTheWholeVolume) {
  const cv::Mat left = reference::noise(37, 75, CV_8UC3, 1), right = reference::noise(37, 75, CV_8UC3, 2);
  const StereoPair pair = prepareImages(left, right);
  const DisparityRange range{-5, 60};
  const SearchTiles tiles = reference::randomTiles(left.size(), range, 7);
  for (const auto type : {MatchingCostType::kRhoCensus, MatchingCostType::kCensus, MatchingCostType::kRho,
                          MatchingCostType::kBirchfieldTomasi, MatchingCostType::kLearned}) {
    for (const int scales : {1, 2}) {
      for (const int bits : {8, 16}) {
        const MatchingCostParams params = paramsOf(type, scales);
        const CostVolume whole = volumeOf(pair, range, params, bits);
        CostVolume rows, searched;
        MatchingCost().compute(pair, range, params, scaleOf(params, bits), rows, 4);
        ASSERT_EQ(rows.height(), 9);
        MatchingCost().complete(pair, params, tiles, rows, 4, searched);
        expectEqual(searched, reference::searchedOf(whole, tiles));
        MatchingCost().complete(pair, params, {}, rows, 4, searched);
        expectEqual(searched, whole);
      }
    }
  }
}

TEST(MatchingCost, HandWorkedAbsoluteDifference) {
  // Grey |100 - 90| = 10: theta(10, 10) = 1 - 1/e; a single row of two values has no census bit at 1 x 3.
  const cv::Mat left = (cv::Mat_<std::uint8_t>(1, 2) << 100, 100);
  const cv::Mat right = (cv::Mat_<std::uint8_t>(1, 2) << 90, 90);
  MatchingCostParams params = paramsOf(MatchingCostType::kAdCensus);
  params.census = {1, 3};
  const CostVolume volume = volumeOf(prepareImages(left, right), {0, 1}, params);
  EXPECT_NEAR(volume.cost(0, 0, 0), 0.63212, 1e-3);
}

TEST(MatchingCost, HandWorkedRho) {
  // Left is a ramp of slope 8 per px, right is flat 40: Sobel / 4 gives (1 + 2 + 1) * 16 / 4 = 16 against 0.
  // At x = 2 both are 40: rho = 0.2 * 0 + 0.8 * 16 = 12.8.
  cv::Mat left(3, 5, CV_8UC1);
  for (int x = 0; x < 5; ++x) left.col(x).setTo(24 + 8 * x);
  const cv::Mat right(3, 5, CV_8UC1, cv::Scalar(40));
  const CostVolume volume = volumeOf(prepareImages(left, right), {0, 1}, paramsOf(MatchingCostType::kRho));
  EXPECT_NEAR(volume.cost(1, 2, 0), 1.0 - std::exp(-1.28), 2e-3);
}

TEST(MatchingCost, EqualPixelsCostNothing) {
  const cv::Mat image = reference::texture(9, 31, CV_8UC3, 1);
  for (const auto type : {MatchingCostType::kRhoCensus, MatchingCostType::kAdCensus, MatchingCostType::kCensus,
                          MatchingCostType::kRho, MatchingCostType::kBirchfieldTomasi}) {
    const CostVolume volume = volumeOf(prepareImages(image, image), {0, 4}, paramsOf(type));
    for (int x = 0; x < image.cols; ++x) EXPECT_EQ(volume.raw(4, x, 0), 0);
  }
}

constexpr MatchingCostType kTypes[] = {MatchingCostType::kRhoCensus, MatchingCostType::kAdCensus,
                                       MatchingCostType::kCensus, MatchingCostType::kRho,
                                       MatchingCostType::kBirchfieldTomasi};
class EveryType : public testing::TestWithParam<MatchingCostType> {};
INSTANTIATE_TEST_SUITE_P(MatchingCost, EveryType, testing::ValuesIn(kTypes));

TEST_P(EveryType, EqualsTheReference) {
  for (const int image_type : {CV_8UC1, CV_8UC3}) {
    for (const int scales : {1, 3}) {
      const StereoPair pair =
          prepareImages(reference::texture(11, 27, image_type, 3), reference::texture(11, 27, image_type, 4));
      MatchingCostParams params = paramsOf(GetParam(), scales);
      params.rho_weight = 0.5;
      const DisparityRange range{-3, 9};
      const CostVolume volume = volumeOf(pair, range, params);
      for (int y = 0; y < 11; y += 5) {
        for (int x = 0; x < 27; x += 2) {
          for (int i = 0; i < range.count; ++i) {
            const int x_right = x - (range.min + i);
            if (x_right < 0 || x_right >= 27) continue;
            ASSERT_NEAR(volume.cost(y, x, i), reference::matchingCost(pair, x, x_right, y, params), kTolerance)
                << x << ", " << y << ", index " << i;
          }
        }
      }
    }
  }
}

TEST_P(EveryType, EightBitsAreSixteenBitsRounded) {
  const StereoPair pair = prepareImages(reference::texture(7, 40, CV_8UC3, 5), reference::texture(7, 40, CV_8UC3, 6));
  const MatchingCostParams params = paramsOf(GetParam());
  const CostVolume exact = volumeOf(pair, {0, 20}, params, 16);
  const CostVolume rounded = volumeOf(pair, {0, 20}, params, 8);
  ASSERT_EQ(rounded.depth(), CostVolume::Depth::kU8);
  for (int x = 0; x < 40; ++x) {
    for (int i = 0; i < 20; ++i) {
      ASSERT_NEAR(rounded.cost(3, x, i), exact.cost(3, x, i),
                  0.51 * (2.0F * rounded.step() + exact.step()) + 2 * kThetaError);
    }
  }
}

TEST_P(EveryType, CostsStayBelowTheirMaximum) {
  cv::Mat black(5, 24, CV_8UC3, cv::Scalar::all(0));
  black.col(11).setTo(255);
  const cv::Mat white = ~black;
  for (const int bits : {8, 16}) {
    const MatchingCostParams params = paramsOf(GetParam(), 3);
    const CostVolume volume = volumeOf(prepareImages(black, white), {0, 12}, params, bits);
    EXPECT_LE(volume.maxRaw(), bits == 8 ? 200 : 4000);
    for (int i = 0; i < 12; ++i) EXPECT_LE(volume.raw(2, 11, i), volume.maxRaw());
    for (int i = 12; i < volume.stride(); ++i) EXPECT_GE(volume.raw(2, 11, i), volume.maxRaw()) << "padding never wins";
  }
}

using MatchingCostKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(MatchingCostKernel);

TEST_P(MatchingCostKernel, GivesTheSameBits) {
  const StereoPair pair = prepareImages(reference::texture(13, 53, CV_8UC3, 7), reference::texture(13, 53, CV_8UC3, 8));
  std::vector<MatchingCostType> types(std::begin(kTypes), std::end(kTypes));
  types.push_back(MatchingCostType::kLearned);
  for (const MatchingCostType type : types) {
    for (const int bits : {8, 16}) {
      const auto volume = [&] { return volumeOf(pair, {-2, 37}, paramsOf(type, 3), bits); };
      expectEqual(onThisSet(volume), onBaseline(volume));
    }
  }
}

TEST_P(EveryType, AShiftIsFoundAtItsDisparity) {
  const cv::Mat wide = reference::texture(9, 60, CV_8UC3, 9);
  const StereoPair pair = prepareImages(wide.colRange(0, 50).clone(), wide.colRange(6, 56).clone());
  const CostVolume volume = volumeOf(pair, {0, 12}, paramsOf(GetParam()));
  for (int x = 16; x < 45; ++x) {
    for (int i = 0; i < 12; ++i) EXPECT_GE(volume.raw(4, x, i), volume.raw(4, x, 6)) << x << ", " << i;
  }
}

TEST(MatchingCost, RepeatsAlongTheDisparityWhereTheRightImageEnds) {
  const StereoPair pair = prepareImages(reference::texture(5, 20, CV_8UC3, 1), reference::texture(5, 20, CV_8UC3, 2));
  const CostVolume volume = volumeOf(pair, {0, 16}, paramsOf(MatchingCostType::kRhoCensus));
  for (int x = 0; x < 15; ++x) {
    for (int i = x + 1; i < 16; ++i) EXPECT_EQ(volume.raw(2, x, i), volume.raw(2, x, x));
  }
  const CostVolume verged = volumeOf(pair, {-16, 16}, paramsOf(MatchingCostType::kRhoCensus));
  for (int x = 5; x < 19; ++x) {  // x - d <= 19 from index x - 3 on
    for (int i = 0; i < x - 3; ++i) EXPECT_EQ(verged.raw(2, x, i), verged.raw(2, x, x - 3));
  }
}

TEST(MatchingCost, RepeatsThePixelWhereAsked) {
  const StereoPair pair = prepareImages(reference::texture(5, 20, CV_8UC3, 1), reference::texture(5, 20, CV_8UC3, 2));
  MatchingCostParams params = paramsOf(MatchingCostType::kRhoCensus);
  params.border = CostBorder::kRepeatPixel;
  const CostVolume volume = volumeOf(pair, {0, 16}, params);
  for (int i = 0; i < 16; ++i) {
    for (int x = 0; x < i; ++x) EXPECT_EQ(volume.raw(2, x, i), volume.raw(2, i, i));
  }
}

TEST(MatchingCost, TakesNarrowImagesAndWideRanges) {
  for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 9}, {9, 1}, {3, 4}}) {
    const StereoPair pair =
        prepareImages(reference::noise(rows, cols, CV_8UC3, 1), reference::noise(rows, cols, CV_8UC3, 2));
    for (const DisparityRange range : {DisparityRange{0, 40}, {-40, 30}, {10, 5}}) {
      const CostVolume volume = volumeOf(pair, range, paramsOf(MatchingCostType::kRhoCensus, 3));
      for (int i = 0; i < range.count; ++i) EXPECT_LE(volume.raw(rows - 1, cols - 1, i), volume.maxRaw());
    }
  }
}

TEST(MatchingCost, NeverModifiesTheImages) {
  const cv::Mat left = reference::noise(9, 30, CV_8UC1, 1);
  const cv::Mat right = reference::noise(9, 30, CV_8UC1, 2);
  const cv::Mat left_copy = left.clone();
  const cv::Mat right_copy = right.clone();
  volumeOf(prepareImages(left, right), {0, 8}, paramsOf(MatchingCostType::kRhoCensus, 3));
  EXPECT_EQ(cv::norm(left, left_copy, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(right, right_copy, cv::NORM_INF), 0.0);
}

TEST(MatchingCost, RefusesACensusThatThereIsNot) {
  StereoPair pair = prepareImages(reference::noise(9, 30, CV_8UC1, 1), reference::noise(9, 30, CV_8UC1, 2));
  MatchingCostParams params = paramsOf(MatchingCostType::kRhoCensus);
  params.census = {4, 5};
  EXPECT_THROW(volumeOf(pair, {0, 8}, params), std::invalid_argument);
  params.census = {5, 5};
  pair.right_grey.convertTo(pair.right_grey, CV_32F);
  EXPECT_THROW(volumeOf(pair, {0, 8}, params), std::invalid_argument);
}

TEST(MatchingCost, LetsGoOfTheImages) {
  const cv::Mat colour = reference::noise(9, 30, CV_8UC3, 1);
  const StereoPair pair = prepareImages(colour, colour);
  const auto owners = [&] { return pair.left.u->refcount + pair.left_grey.u->refcount + pair.right_grey.u->refcount; };
  const int before = owners();
  MatchingCost matching_cost;
  CostVolume volume;
  const MatchingCostParams params = paramsOf(MatchingCostType::kRhoCensus, 3);
  matching_cost.compute(pair, {0, 8}, params, scaleOf(params), volume);
  EXPECT_EQ(owners(), before);
}

TEST(MatchingCost, CensusSeesThe16BitsThatColourDoesNot) {
  cv::Mat left;
  cv::Mat right;
  reference::texture(9, 30, CV_8UC1, 1).convertTo(left, CV_16U);
  reference::texture(9, 30, CV_8UC1, 2).convertTo(right, CV_16U);
  const CostVolume small = volumeOf(prepareImages(left, right), {0, 8}, paramsOf(MatchingCostType::kCensus));
  const CostVolume large =
      volumeOf(prepareImages(left * 256, right * 256), {0, 8}, paramsOf(MatchingCostType::kCensus));
  expectEqual(small, large);
}

}  // namespace
}  // namespace fdp_stereo
