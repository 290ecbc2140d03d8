// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hole_filling.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(HoleFilling, HandWorkedCase) {
  // The smaller side is the background; at the border the only side counts; the empty row takes the row above, the
  // nearer of two at the same distance being the upper one.
  cv::Mat disparity = (cv::Mat_<float>(3, 5) << kNone, 7.0F, kNone, kNone, 3.0F,  //
                       kNone, kNone, kNone, kNone, kNone,                         //
                       2.0F, kNone, 5.0F, kNone, kNone);
  fillHoles(disparity);
  const cv::Mat expected = (cv::Mat_<float>(3, 5) << 7.0F, 7.0F, 3.0F, 3.0F, 3.0F,  //
                            7.0F, 7.0F, 3.0F, 3.0F, 3.0F,                           //
                            2.0F, 2.0F, 5.0F, 5.0F, 5.0F);
  EXPECT_EQ(reference::differingPixels(disparity, expected), 0);
}

TEST(HoleFilling, EqualsTheReference) {
  for (const auto& [rows, cols] : {std::pair{1, 31}, {31, 1}, {17, 23}}) {
    const cv::Mat before = reference::randomDisparity(rows, cols, -9.0, 9.0, 0.8, 4);
    cv::Mat after = before.clone();
    fillHoles(after);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < cols; ++x) {
        int donor = y;
        for (int step = 1; std::isnan(reference::filledFromRow(before, x, donor)); ++step) {
          const int up = y - step;
          const int down = y + step;
          donor = up >= 0 && !std::isnan(reference::filledFromRow(before, x, up)) ? up : std::min(down, rows - 1);
        }
        ASSERT_EQ(after.at<float>(y, x), reference::filledFromRow(before, x, donor)) << x << ", " << y;
      }
    }
  }
}

TEST(HoleFilling, LeavesWhatIsKnownAndFillsAllElse) {
  const cv::Mat before = reference::randomDisparity(20, 30, 0.0, 9.0, 0.5, 6);
  cv::Mat after = before.clone();
  fillHoles(after);
  EXPECT_EQ(cv::countNonZero(after == after), 600);
  cv::Mat known = after.clone();
  known.setTo(kNone, ~(before == before));
  EXPECT_EQ(reference::differingPixels(known, before), 0);
}

TEST(HoleFilling, LargerHolesStay) {
  cv::Mat disparity = (cv::Mat_<float>(2, 7) << 5.0F, kNone, 5.0F, kNone, kNone, 4.0F, 4.0F,  //
                       5.0F, 5.0F, 5.0F, kNone, 4.0F, 4.0F, 4.0F);
  fillHoles(disparity, 2);
  const cv::Mat expected = (cv::Mat_<float>(2, 7) << 5.0F, 5.0F, 5.0F, kNone, kNone, 4.0F, 4.0F,  //
                            5.0F, 5.0F, 5.0F, kNone, 4.0F, 4.0F, 4.0F);
  EXPECT_EQ(reference::differingPixels(disparity, expected), 0);
}

TEST(HoleFilling, AMapWithoutAnyDisparityStays) {
  cv::Mat none(4, 5, CV_32FC1, cv::Scalar(kNone));
  fillHoles(none);
  EXPECT_EQ(cv::countNonZero(none == none), 0);
}

}  // namespace
}  // namespace fdp_stereo
