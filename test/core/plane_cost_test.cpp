// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/plane_cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <opencv2/core.hpp>

#include "reference/instruction_sets.hpp"
#include "reference/local_expansion_reference.hpp"

namespace fdp_stereo::local_expansion {
namespace {

cv::Mat randomImage(int width, int height, int type, int seed) {
  cv::Mat image(height, width, type);
  cv::RNG random(seed);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

CostVolume randomVolume(int width, int height, int entries, CostVolume::Depth depth, int max_raw, int seed) {
  CostVolume volume;
  volume.create(height, width, {0, entries}, depth, 1.0F / static_cast<float>(max_raw), max_raw);
  volume.clearPadding();
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> raw(0, max_raw);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int i = 0; i < entries; ++i) volume.setRaw(y, x, i, raw(random));
    }
  }
  return volume;
}

struct Case {
  int width, height, count, min, steps, radius, type;
  CostVolume::Depth depth;
};

class PlaneCostCases : public testing::TestWithParam<Case> {};

/// Every pixel of several target rectangles, against a guided filter of the whole image in double.
TEST_P(PlaneCostCases, CroppedFilterIsTheWholeImageFilter) {
  const Case& c = GetParam();
  const cv::Mat image = randomImage(c.width, c.height, c.type, 7);
  const int entries = (c.count - 1) * c.steps + 1;
  const int max_raw = c.depth == CostVolume::Depth::kU8 ? 200 : 5000;
  const CostVolume volume = randomVolume(c.width, c.height, entries, c.depth, max_raw, 8);
  const FilterGuide guide = makeFilterGuide(image, c.radius, 1e-4);
  const PlaneCost cost(volume, {c.min, c.count}, c.steps, guide, {0.8, 0.6, 0});
  PlaneBatch batch;
  const float middle = static_cast<float>(c.min) + 0.5F * static_cast<float>(c.count - 1);
  batch[0] = {0.0F, 0.0F, middle};
  batch[1] = {0.06F, -0.04F, middle - 0.3F};
  batch[2] = {-0.11F, 0.02F, middle + 0.7F};
  batch[3] = {0.3F, 0.2F, static_cast<float>(c.min)};
  PlaneCostBuffers buffers;
  for (const cv::Rect& wanted :
       {cv::Rect(0, 0, c.width, c.height), cv::Rect(3, 2, 5, 4), cv::Rect(c.width - 2, 0, 2, 3),
        cv::Rect(0, c.height - 1, c.width, 1), cv::Rect(c.width / 2, c.height / 2, 1, 1)}) {
    const cv::Rect target = wanted & cv::Rect(0, 0, c.width, c.height);
    if (target.empty()) continue;
    cost.evaluate(batch, target, buffers);
    for (int k = 0; k < kPlaneBatch; ++k) {
      const reference::ReferencePlane plane{batch[k].a, batch[k].b, batch[k].c};
      std::vector<double> raw;
      for (int y = 0; y < c.height; ++y) {
        for (int x = 0; x < c.width; ++x) {
          raw.push_back(reference::rawPlaneCost(volume, entries, c.min, c.steps, 0.8, 0.6, plane, x, y));
        }
      }
      const std::vector<double> expected = reference::guidedFilter(image, raw, c.radius, 1e-4);
      for (int y = 0; y < target.height; ++y) {
        for (int x = 0; x < target.width; ++x) {
          if (!cost.isValid(batch[k], target.x + x, target.y + y)) continue;
          ASSERT_NEAR(buffers.costs(k)[y * target.width + x], expected[(target.y + y) * c.width + target.x + x], 2e-4)
              << "plane " << k << " at " << target.x + x << ", " << target.y + y;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PlaneCostCases,
                         testing::Values(Case{31, 23, 16, 0, 1, 4, CV_8UC3, CostVolume::Depth::kU8},
                                         Case{40, 33, 9, -3, 4, 3, CV_8UC3, CostVolume::Depth::kU16},
                                         Case{17, 29, 20, 2, 2, 10, CV_8UC1, CostVolume::Depth::kU8},
                                         Case{9, 1, 5, 0, 1, 2, CV_8UC3, CostVolume::Depth::kU16},
                                         Case{12, 7, 1, 4, 1, 3, CV_8UC3, CostVolume::Depth::kU8},
                                         Case{14, 15, 33, 0, 1, 1, CV_8UC3, CostVolume::Depth::kU8}));

using PlaneCostKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(PlaneCostKernel);

TEST_P(PlaneCostKernel, GivesTheSameBits) {
  const cv::Mat image = randomImage(60, 50, CV_8UC3, 1);
  const FilterGuide guide = makeFilterGuide(image, 5, 1e-4);
  const PlaneBatch batch = {Plane{0.1F, 0.1F, 12.0F}, Plane{0.0F, -0.2F, 25.0F}, Plane{0.3F, 0.0F, 9.3F}, Plane{}};
  const cv::Rect target(7, 5, 33, 29);
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    const CostVolume volume = randomVolume(60, 50, 40, depth, 250, 2);
    const PlaneCost cost(volume, {0, 40}, 1, guide, {1.0, 0.5, 5});
    const auto costs = [&] {
      PlaneCostBuffers buffers;
      cost.evaluate(batch, target, buffers);
      std::vector<float> values;
      for (int k = 0; k < kPlaneBatch; ++k) {
        values.insert(values.end(), buffers.costs(k), buffers.costs(k) + target.area());
      }
      return values;
    };
    EXPECT_EQ(onThisSet(costs), onBaseline(costs));
  }
}

TEST(PlaneCost, PlanesThatLeaveTheRangeAreInvalid) {
  const cv::Mat image = randomImage(30, 20, CV_8UC3, 1);
  const CostVolume volume = randomVolume(30, 20, 10, CostVolume::Depth::kU8, 250, 2);
  const FilterGuide guide = makeFilterGuide(image, 2, 1e-4);
  const PlaneCost cost(volume, {0, 10}, 1, guide, {1.0, 0.5, 5});
  // d = 0.5 x: with the margin of 5 px (2.5 px of disparity) valid from d = 2.5 to 6.5, x = 5 to 13.
  const Plane slope{0.5F, 0.0F, 0.0F};
  PlaneCostBuffers buffers;
  cost.evaluate({slope, Plane{0.0F, 0.0F, -0.1F}, Plane{0.0F, 0.0F, 9.0F}, slope}, {0, 0, 30, 20}, buffers);
  for (int x = 0; x < 30; ++x) {
    EXPECT_EQ(cost.isValid(slope, x, 3), x >= 5 && x <= 13) << x;
    EXPECT_EQ(buffers.costs(0)[3 * 30 + x] == kInvalidCost, x < 5 || x > 13) << x;
    EXPECT_EQ(buffers.costs(1)[3 * 30 + x], kInvalidCost);
    EXPECT_LT(buffers.costs(2)[3 * 30 + x], 1.0F);
  }
}

}  // namespace
}  // namespace fdp_stereo::local_expansion
