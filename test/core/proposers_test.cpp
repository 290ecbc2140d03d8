// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/proposers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace fdp_stereo::local_expansion {
namespace {

Labels constantLabels(int width, int height, const Plane& plane) {
  Labels labels;
  labels.create({width, height});
  for (std::size_t i = 0; i < labels.cost.size(); ++i) labels.planes.set(i, plane);
  return labels;
}

TEST(Proposers, ExpansionTakesPlanesOfTheCellOnly) {
  Labels labels = constantLabels(8, 8, {0.0F, 0.0F, 1.0F});
  labels.planes.set(labels.index(2, 3), {0.0F, 0.0F, 2.0F});
  labels.planes.set(labels.index(3, 3), {0.0F, 0.0F, 3.0F});
  Random random({1});
  std::set<float> seen;
  for (int i = 0; i < 100; ++i) seen.insert(proposeExpansion(labels, {2, 3, 2, 1}, random).c);
  EXPECT_EQ(seen, (std::set<float>{2.0F, 3.0F}));
}

TEST(Proposers, RandomStaysWithinReachAndRange) {
  const Labels labels = constantLabels(8, 8, {0.1F, 0.0F, 9.0F});
  Random random({2});
  for (int i = 0; i < 500; ++i) {
    const Plane plane = proposeRandom(labels, {4, 4, 1, 1}, {0, 11}, 2.0F, 0.1F, random);
    EXPECT_GE(plane.at(4, 4), 9.4F - 2.001F);
    EXPECT_LE(plane.at(4, 4), 10.001F);
    EXPECT_NEAR(plane.a, 0.1F, 0.15F);
    EXPECT_NEAR(plane.b, 0.0F, 0.15F);
  }
}

TEST(Proposers, FitFindsThePlaneAmongOutliersAndUsesAllInliers) {
  std::vector<SurfacePoint> points;
  Random random({3});
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const float noise = random.uniform(-0.2F, 0.2F);
      const bool outlier = random.uniform() < 0.3F;
      const float d = 0.2F * static_cast<float>(x) - 0.1F * static_cast<float>(y) + 7.0F + noise;
      points.push_back({static_cast<float>(x), static_cast<float>(y), outlier ? random.uniform(20.0F, 50.0F) : d});
    }
  }
  const Plane plane = fitPlane(points, {1.0, 100}, random);
  EXPECT_NEAR(plane.a, 0.2F, 0.01F);
  EXPECT_NEAR(plane.b, -0.1F, 0.01F);
  EXPECT_NEAR(plane.at(10, 10), 8.0F, 0.05F);
}

TEST(Proposers, FitOfPointsWithoutAPlaneIsTheirMedian) {
  Random random({4});
  std::vector<SurfacePoint> two = {{0.0F, 0.0F, 3.0F}, {1.0F, 0.0F, 5.0F}};
  EXPECT_EQ(fitPlane(two, {1.0, 50}, random).c, 5.0F);
  std::vector<SurfacePoint> line;
  for (int i = 0; i < 9; ++i) line.push_back({static_cast<float>(i), 0.0F, static_cast<float>(i)});
  const Plane plane = fitPlane(line, {1.0, 50}, random);
  EXPECT_EQ(plane.a, 0.0F);
  EXPECT_EQ(plane.c, 4.0F);
  std::vector<SurfacePoint> none;
  EXPECT_EQ(fitPlane(none, {1.0, 50}, random).c, 0.0F);
}

TEST(Proposers, InitialPlanesLieWithinTheAngle) {
  Random random({5});
  for (int i = 0; i < 500; ++i) {
    const Plane plane = randomPlane(3.0F, 4.0F, 6.0F, 1.0F, random);
    EXPECT_NEAR(plane.at(3, 4), 6.0F, 1e-4F);
    EXPECT_LE(std::hypot(plane.a, plane.b), std::tan(1.0F) + 1e-4F);
  }
}

TEST(Random, IsUniformAndKeyed) {
  Random a({1, 2});
  Random b({1, 2});
  Random c({2, 1});
  EXPECT_EQ(a.next(), b.next());
  EXPECT_NE(a.next(), c.next());
  double sum = 0.0;
  std::array<int, 5> count{};
  for (int i = 0; i < 20000; ++i) {
    const float u = a.uniform();
    ASSERT_GE(u, 0.0F);
    ASSERT_LT(u, 1.0F);
    sum += static_cast<double>(u);
    ++count[a.below(5)];
  }
  EXPECT_NEAR(sum / 20000, 0.5, 0.01);
  for (const int n : count) EXPECT_NEAR(n, 4000, 300);
}

}  // namespace
}  // namespace fdp_stereo::local_expansion
