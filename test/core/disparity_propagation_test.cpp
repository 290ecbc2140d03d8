// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/disparity_propagation.hpp"

#include <cmath>
#include <limits>
#include <queue>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include "reference/disparity_propagation_reference.hpp"
#include "reference/instruction_sets.hpp"
#include "seeds/surface_propagation.hpp"

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

// The colour distance is the mean over the channels: (|1| + |2| + |4|) / 3 = 7 / 3; 200 (1 - exp(-7 / 30)) = 41.6.
TEST(DisparityPropagation, ColourIsTheMeanOverChannels) {
  const cv::Mat left = (cv::Mat_<cv::Vec3b>(1, 2) << cv::Vec3b(10, 20, 30), cv::Vec3b(11, 22, 26));
  CostVolume volume = constantVolume(left.size(), {0, 2}, CostVolume::Depth::kU16, 200);
  propagateDisparity({seedAt(0, 0, 1)}, left, windowParams(3, 10.0), volume);
  EXPECT_EQ(volume.raw(0, 1, 1), 42);
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

TEST(DisparityPropagation, PassesOverSeedsThatAreNoNumbers) {
  const cv::Mat left(20, 20, CV_8UC1, cv::Scalar(7));
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const PropagationForm form : {PropagationForm::kWindow, PropagationForm::kSurface}) {
    DisparityPropagationParams params;
    params.form = form;
    const Seed good = seedAt(10, 10, 2);
    CostVolume expected = constantVolume(left.size(), {0, 5}, CostVolume::Depth::kU8, 100);
    CostVolume volume = expected;
    propagateDisparity({good}, left, params, expected);
    Seed distrusted = good;
    distrusted.trust = kNaN;
    const Seeds seeds = {seedAt(10, 10, kNaN), seedAt(kNaN, 10, 2),   seedAt(10, kInf, 2), good,
                         seedAt(10, 10, kInf), seedAt(10, 10, -kInf), distrusted};
    propagateDisparity(seeds, left, params, volume);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(volume.raw(10, 10, i), expected.raw(10, 10, i));
    EXPECT_EQ(propagateDisparity({distrusted}, left, params, volume), 0.0);
  }
}

DisparityPropagationParams surfaceParams() {
  DisparityPropagationParams params;
  params.form = PropagationForm::kSurface;
  return params;
}

/// Disparity of the smallest cost by a parabola through it and its neighbours.
double minimum(const CostVolume& volume, int y, int x) {
  int best = 0;
  for (int i = 1; i < volume.range().count; ++i) {
    if (volume.raw(y, x, i) < volume.raw(y, x, best)) best = i;
  }
  if (best == 0 || best == volume.range().count - 1) return best + volume.range().min;
  const double before = volume.raw(y, x, best - 1);
  const double after = volume.raw(y, x, best + 1);
  const double curvature = before - 2.0 * volume.raw(y, x, best) + after;
  return best + volume.range().min + (curvature > 0.0 ? 0.5 * (before - after) / curvature : 0.0);
}

// No texture, and seeds 16 px apart on a slanted plane: every pixel gets the plane, to a fraction of a pixel.
TEST(SurfacePropagation, ReachesAllOfASlantedPlane) {
  const cv::Mat left(96, 128, CV_8UC3, cv::Scalar(90, 100, 110));
  const auto plane = [](double x, double y) { return -2.0 + 0.06 * x + 0.03 * y; };
  Seeds seeds;
  for (int y = 8; y < 96; y += 16) {
    for (int x = 8; x < 128; x += 16) {
      seeds.push_back(seedAt(static_cast<float>(x), static_cast<float>(y), static_cast<float>(plane(x, y))));
    }
  }
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    CostVolume volume = constantVolume(left.size(), {-3, 16}, depth, 120);
    EXPECT_EQ(propagateDisparity(seeds, left, surfaceParams(), volume), 1.0);
    double worst = 0.0;
    double sum = 0.0;
    for (int y = 4; y < 92; ++y) {
      for (int x = 4; x < 124; ++x) {
        const double error = std::abs(minimum(volume, y, x) - plane(x, y));
        worst = std::max(worst, error);
        sum += error;
      }
    }
    EXPECT_LT(worst, 0.5);
    EXPECT_LT(sum / (88.0 * 120.0), 0.12);
  }
}

TEST(SurfacePropagation, StopsAtAnImageEdge) {
  cv::Mat left(40, 80, CV_8UC1, cv::Scalar(60));
  left(cv::Rect(40, 0, 40, 40)) = 160;
  const Seeds seeds = {seedAt(34, 20, 4), seedAt(60, 20, 12)};
  CostVolume volume = constantVolume(left.size(), {0, 16}, CostVolume::Depth::kU8, 120);
  propagateDisparity(seeds, left, surfaceParams(), volume);
  EXPECT_NEAR(minimum(volume, 20, 38), 4.0, 0.2);
  EXPECT_NEAR(minimum(volume, 20, 42), 12.0, 0.2);  // the other seed is nearer, but behind the edge
}

TEST(SurfacePropagation, DoesNotPinTheSubpixelValue) {
  const cv::Mat left(40, 40, CV_8UC1, cv::Scalar(60));
  for (const float d : {7.0F, 7.25F, 7.5F, 7.75F}) {
    CostVolume volume = constantVolume(left.size(), {0, 16}, CostVolume::Depth::kU16, 100);
    propagateDisparity({seedAt(20, 20, d)}, left, surfaceParams(), volume);
    EXPECT_NEAR(minimum(volume, 20, 20), d, 0.13);
  }
}

TEST(SurfacePropagation, WeighsByTrust) {
  const cv::Mat left(40, 40, CV_8UC1, cv::Scalar(60));
  const auto loweredBy = [&](float trust) {
    CostVolume volume = constantVolume(left.size(), {0, 16}, CostVolume::Depth::kU8, 200);
    Seed seed = seedAt(20, 20, 7);
    seed.trust = trust;
    propagateDisparity({seed}, left, surfaceParams(), volume);
    return 200 - volume.raw(20, 20, 7);
  };
  EXPECT_GT(loweredBy(1.0F), 80);
  EXPECT_NEAR(loweredBy(0.5F), loweredBy(1.0F) / 2, 3);
  EXPECT_LT(loweredBy(0.05F), 10);
}

TEST(SurfacePropagation, PlaneSurvivesAWrongNeighbour) {
  const cv::Mat left(96, 96, CV_8UC1, cv::Scalar(60));
  Seeds seeds;
  for (int y = 8; y < 96; y += 16) {
    for (int x = 8; x < 96; x += 16)
      seeds.push_back(seedAt(static_cast<float>(x), static_cast<float>(y), 5.0F + 0.1F * static_cast<float>(x)));
  }
  seeds[14].d += 9.0F;  // neighbour of seed 15
  const SeedPlane plane = fitPlanes(seeds, spreadSeeds(seeds, left, 10.0, 30.0))[15];
  EXPECT_NEAR(plane.d0, seeds[15].d, 0.15);
  EXPECT_NEAR(plane.slope(0), 0.1, 0.02);
  EXPECT_NEAR(plane.slope(1), 0.0, 0.02);
}

/// Length of the cheapest way from a seed to every cell (Dijkstra), on the same grid of 2 x 2 px cells.
cv::Mat referenceDistance(cv::Point seed, const cv::Mat& cells, double gamma, double reach_px) {
  cv::Mat distance(cells.size(), CV_64FC1, cv::Scalar(1e9));
  using Entry = std::pair<double, std::pair<int, int>>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  distance.at<double>(seed) = 0.0;
  queue.push({0.0, {seed.x, seed.y}});
  while (!queue.empty()) {
    const auto [length, at] = queue.top();
    queue.pop();
    const cv::Point p(at.first, at.second);
    if (length > distance.at<double>(p)) continue;
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point q = p + step;
      if (!cv::Rect(0, 0, cells.cols, cells.rows).contains(q)) continue;
      const double over = length + 2.0 / reach_px + std::abs(cells.at<uchar>(p) - cells.at<uchar>(q)) / gamma;
      if (over < distance.at<double>(q)) {
        distance.at<double>(q) = over;
        queue.push({over, {q.x, q.y}});
      }
    }
  }
  return distance;
}

// Two rounds of sweeps find every way of up to seven turns; on a scene of some blocks that is the cheapest.
TEST(SurfacePropagation, WaysEqualTheReference) {
  cv::Mat cells(30, 40, CV_8UC1, cv::Scalar(60));
  cells(cv::Rect(8, 5, 10, 12)) = 100;
  cells(cv::Rect(25, 10, 4, 20)) = 30;
  cv::Mat left(60, 80, CV_8UC1);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) left.at<uchar>(y, x) = cells.at<uchar>(y / 2, x / 2);
  }
  const GeodesicMap map = spreadSeeds({seedAt(22, 20, 1)}, left, 10.0, 30.0);
  const cv::Mat expected = referenceDistance({11, 10}, cells, 10.0, 30.0);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      EXPECT_NEAR(map.distance.at<float>(y, x), expected.at<double>(y, x), 1e-3);
      EXPECT_EQ(map.owner.at<int>(y, x), 0);
    }
  }
}

using SurfacePropagationKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(SurfacePropagationKernel);

TEST_P(SurfacePropagationKernel, GivesTheSameBits) {
  cv::RNG rng(8);
  cv::Mat left(61, 83, CV_8UC3);
  rng.fill(left, cv::RNG::UNIFORM, 0, 80);
  Seeds seeds;
  for (int i = 0; i < 50; ++i)
    seeds.push_back(seedAt(rng.uniform(0.0F, 82.0F), rng.uniform(0.0F, 60.0F), rng.uniform(0.0F, 20.0F)));
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    const auto costs = [&] {
      CostVolume volume = constantVolume(left.size(), {0, 21}, depth, 120);
      propagateDisparity(seeds, left, surfaceParams(), volume);
      std::vector<int> values;
      for (int y = 0; y < 61; ++y) {
        for (int x = 0; x < 83; ++x) {
          for (int i = 0; i < 21; ++i) values.push_back(volume.raw(y, x, i));
        }
      }
      return values;
    };
    EXPECT_EQ(onThisSet(costs), onBaseline(costs));
  }
}

// Rows of seeds on a floor: the steps from row to row are larger than the scatter that the fit forgives at the end.
TEST(SurfacePropagation, FindsSteepPlanes) {
  const cv::Mat left(80, 80, CV_8UC1, cv::Scalar(60));
  Seeds seeds;
  for (int y = 4; y < 80; y += 8) {
    for (int x = 4; x < 80; x += 8) {
      seeds.push_back(seedAt(static_cast<float>(x), static_cast<float>(y), 5.0F + 0.8F * static_cast<float>(y)));
    }
  }
  const std::vector<SeedPlane> planes = fitPlanes(seeds, spreadSeeds(seeds, left, 10.0, 30.0));
  for (const SeedPlane& plane : planes) {
    EXPECT_NEAR(plane.slope(0), 0.0, 0.02);
    EXPECT_NEAR(plane.slope(1), 0.8, 0.02);
  }
}

// Entry i of such a volume is disparity -2 + i / 4.
TEST(SurfacePropagation, TakesVolumesWithFractionsOfAPixel) {
  const cv::Mat left(20, 20, CV_8UC1, cv::Scalar(60));
  const Seeds seeds = {seedAt(10, 10, 3.25F)};
  CostVolume volume = constantVolume(left.size(), {0, 41}, CostVolume::Depth::kU16, 100);
  propagateDisparity(seeds, left, surfaceParams(), {-2, 4}, volume);
  EXPECT_NEAR(minimum(volume, 10, 10), 4.0 * (3.25 + 2.0), 0.5);
  EXPECT_NEAR(volume.raw(10, 10, 0), volume.raw(10, 10, 40), 2) << "far from the surface, all are alike";
  CostVolume window = constantVolume(left.size(), {0, 41}, CostVolume::Depth::kU8, 100);
  propagateDisparity(seeds, left, windowParams(3, 10.0), {-2, 4}, window);
  EXPECT_EQ(window.raw(10, 10, 21), 0);
  EXPECT_EQ(window.raw(10, 10, 20), 100);
}

TEST(SurfacePropagation, OddInput) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 1), cv::Size(1, 9)}) {
    const cv::Mat left(size, CV_8UC1, cv::Scalar(60));
    CostVolume volume = constantVolume(size, {0, 1}, CostVolume::Depth::kU8, 120);
    EXPECT_GT(propagateDisparity({seedAt(0, 0, 0), seedAt(0, 0, 0), seedAt(50, 0, 0)}, left, surfaceParams(), volume),
              0.0);
    DisparityPropagationParams params = surfaceParams();
    params.reach_px = 0.0;
    EXPECT_THROW(propagateDisparity({}, left, params, volume), std::invalid_argument);
  }
}

}  // namespace
}  // namespace fdp_stereo
