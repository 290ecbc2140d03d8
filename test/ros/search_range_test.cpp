// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "search_range.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace fdp_stereo {
namespace {

const StereoGeometry kCamera{500.0, 0.1, 0.0};  // f T = 50 px m

TEST(SearchRange, ErrorsGrowWithTheSquareOfTheDepth) {
  EXPECT_EQ(depthErrors(0.25, kCamera),
            "depth error (1 sigma, 0.25 px of disparity): 0.005 m at 1 m, 0.02 m at 2 m, 0.12 m at 5 m, 0.5 m at 10 m");
}

TEST(SearchRange, TheRangeForADistanceSeesIt) {
  for (const int min : {-20, 0, 8}) {
    for (const double offset : {0.0, 12.5}) {
      const StereoGeometry camera{500.0, 0.1, offset};
      for (const double nearest : {0.3, 0.5, 1.0, 3.3}) {
        const int count = disparityRangeFor(nearest, min, camera);
        EXPECT_EQ(count % 16, 0);
        EXPECT_LE(camera.depth(DisparityRange{min, count}.max()), nearest);
        if (count > 16) {
          EXPECT_GT(camera.depth(DisparityRange{min, count - 16}.max()), nearest);
        }
      }
    }
  }
}

TEST(SearchRange, ADistanceThatNoRangeSeesIsRefused) {
  EXPECT_EQ(disparityRangeFor(1000.0, 8, kCamera), 16);
  EXPECT_THROW(disparityRangeFor(0.001, 0, kCamera), std::invalid_argument);
  EXPECT_THROW(disparityRangeFor(0.0, 0, kCamera), std::invalid_argument);
  EXPECT_THROW(disparityRangeFor(-1.0, 0, kCamera), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
