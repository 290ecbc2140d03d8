// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/subpixel.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace fdp_stereo {
namespace {

TEST(Subpixel, HandWorkedCases) {
  // Rises 3 before and 1 after: the parabola through (-1, 3), (0, 0), (1, 1) has its minimum at 1/4; the V with equal
  // slopes at (1 - 1/3) / 2 = 1/3; blended 1/2 - (1/3 + 1/9) / 4 = 7/18.
  EXPECT_FLOAT_EQ(subpixelOffset(SubpixelFit::kParabola, 5.0F, 2.0F, 3.0F), 0.25F);
  EXPECT_FLOAT_EQ(subpixelOffset(SubpixelFit::kEquiangular, 5.0F, 2.0F, 3.0F), 1.0F / 3.0F);
  EXPECT_FLOAT_EQ(subpixelOffset(SubpixelFit::kBlended, 5.0F, 2.0F, 3.0F), 7.0F / 18.0F);
  EXPECT_FLOAT_EQ(subpixelOffset(SubpixelFit::kNone, 5.0F, 2.0F, 3.0F), 0.0F);
}

class EveryFit : public testing::TestWithParam<SubpixelFit> {};
INSTANTIATE_TEST_SUITE_P(Subpixel, EveryFit,
                         testing::Values(SubpixelFit::kNone, SubpixelFit::kParabola, SubpixelFit::kEquiangular,
                                         SubpixelFit::kBlended));

TEST_P(EveryFit, StaysWithinHalfAPixelAndMirrors) {
  for (float before = 0.0F; before <= 20.0F; ++before) {
    for (float after = 0.0F; after <= 20.0F; ++after) {
      const float offset = subpixelOffset(GetParam(), 7.0F + before, 7.0F, 7.0F + after);
      ASSERT_LE(std::abs(offset), 0.5F) << before << ", " << after;
      ASSERT_FLOAT_EQ(subpixelOffset(GetParam(), 7.0F + after, 7.0F, 7.0F + before), -offset);
      if (GetParam() == SubpixelFit::kNone || before <= after) continue;
      ASSERT_GT(offset, 0.0F) << "towards the smaller cost";
    }
  }
}

TEST_P(EveryFit, IsZeroOnFlatAndSymmetricCosts) {
  EXPECT_EQ(subpixelOffset(GetParam(), 4.0F, 4.0F, 4.0F), 0.0F);
  EXPECT_EQ(subpixelOffset(GetParam(), 9.0F, 4.0F, 9.0F), 0.0F);
}

TEST(Subpixel, EachFitRecoversItsOwnCurve) {
  for (float minimum = -0.45F; minimum <= 0.46F; minimum += 0.05F) {
    const auto parabola = [&](float d) { return 3.0F * (d - minimum) * (d - minimum); };
    const auto v_shape = [&](float d) { return 3.0F * std::abs(d - minimum); };
    EXPECT_NEAR(subpixelOffset(SubpixelFit::kParabola, parabola(-1), parabola(0), parabola(1)), minimum, 1e-5);
    EXPECT_NEAR(subpixelOffset(SubpixelFit::kEquiangular, v_shape(-1), v_shape(0), v_shape(1)), minimum, 1e-5);
  }
}

}  // namespace
}  // namespace fdp_stereo
