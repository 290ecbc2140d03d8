// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/seed_planes.hpp"

#include <gtest/gtest.h>

namespace fdp_stereo::local_expansion {
namespace {

TEST(SeedPlanes, TriangleWorkedByHand) {
  // d = 2 + x / 4 through three corners; the pixels right of the hypotenuse belong to no triangle.
  const SeedPlanes planes({{0.0F, 0.0F, 2.0F}, {8.0F, 0.0F, 4.0F}, {0.0F, 8.0F, 2.0F}}, {12, 12});
  Plane plane;
  ASSERT_TRUE(planes.planeAt(2, 3, plane));
  EXPECT_FLOAT_EQ(plane.a, 0.25F);
  EXPECT_FLOAT_EQ(plane.b, 0.0F);
  EXPECT_FLOAT_EQ(plane.at(2, 3), 2.5F);
  EXPECT_FALSE(planes.planeAt(6, 6, plane));
  EXPECT_FALSE(planes.planeAt(11, 0, plane));
}

TEST(SeedPlanes, SeedsOnOnePlaneGiveThatPlaneEverywhereBetweenThem) {
  std::vector<SurfacePoint> points;
  for (int y = 0; y <= 20; y += 5) {
    for (int x = 0; x <= 30; x += 6) {
      const float fx = static_cast<float>(x) + 0.3F * static_cast<float>(y % 3);
      const float fy = static_cast<float>(y);
      points.push_back({fx, fy, 0.1F * fx - 0.2F * fy + 9.0F});
    }
  }
  const SeedPlanes planes(points, {32, 21});
  for (int y = 1; y < 20; ++y) {
    for (int x = 2; x < 30; ++x) {
      Plane plane;
      ASSERT_TRUE(planes.planeAt(x, y, plane)) << x << ", " << y;
      EXPECT_NEAR(plane.at(x, y), 0.1F * static_cast<float>(x) - 0.2F * static_cast<float>(y) + 9.0F, 1e-3F);
    }
  }
}

TEST(SeedPlanes, TooFewRepeatedOrOutsideGiveNone) {
  EXPECT_TRUE(SeedPlanes({}, {5, 5}).empty());
  EXPECT_TRUE(SeedPlanes({{1.0F, 1.0F, 3.0F}, {1.0F, 1.0F, 4.0F}, {3.0F, 2.0F, 3.0F}}, {5, 5}).empty());
  EXPECT_TRUE(
      SeedPlanes({{-1.0F, 1.0F, 3.0F}, {1.0F, 9.0F, 4.0F}, {3.0F, 2.0F, 3.0F}, {1.0F, 1.0F, 1.0F}}, {5, 5}).empty());
  Plane plane;
  const SeedPlanes line({{0.0F, 0.0F, 1.0F}, {2.0F, 2.0F, 1.0F}, {4.0F, 4.0F, 1.0F}}, {5, 5});
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(line.planeAt(i, i, plane));
}

}  // namespace
}  // namespace fdp_stereo::local_expansion
