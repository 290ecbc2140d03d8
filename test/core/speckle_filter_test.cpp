// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/speckle_filter.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(SpeckleFilter, HandWorkedCase) {
  // Regions with steps up to 1: five pixels around 4 (a chain 3.2 4 4.8 5.5 hangs together), one 9, two 1s.
  cv::Mat disparity = (cv::Mat_<float>(2, 5) << 3.2F, 4.0F, 4.8F, 5.5F, 9.0F, 1.0F, 1.0F, kNone, 5.0F, kNone);
  filterSpeckles(disparity, {3, 1.0});
  const cv::Mat expected = (cv::Mat_<float>(2, 5) << 3.2F, 4.0F, 4.8F, 5.5F, kNone, kNone, kNone, kNone, 5.0F, kNone);
  EXPECT_EQ(reference::differingPixels(disparity, expected), 0);
}

TEST(SpeckleFilter, DiagonalNeighboursAreApart) {
  cv::Mat disparity = (cv::Mat_<float>(2, 2) << 1.0F, kNone, kNone, 1.0F);
  filterSpeckles(disparity, {2, 1.0});
  EXPECT_EQ(cv::countNonZero(disparity == disparity), 0);
}

TEST(SpeckleFilter, RemovesExactlyTheSmallRegions) {
  for (const auto& [rows, cols] : {std::pair{1, 60}, {60, 1}, {23, 31}, {150, 40}}) {
    for (const int max_size : {1, 2, 5, 20}) {
      const cv::Mat before = reference::randomDisparity(rows, cols, 0.0, 6.0, 0.15, 9);
      const std::vector<int> labels = reference::regionLabels(before, 1.5F);
      cv::Mat after = before.clone();
      filterSpeckles(after, {max_size, 1.5});
      for (int p = 0; p < rows * cols; ++p) {
        const bool keep = labels[p] >= 0 && std::count(labels.begin(), labels.end(), labels[p]) >= max_size;
        ASSERT_TRUE(reference::bothNanOrNear(after.at<float>(p / cols, p % cols),
                                             keep ? before.at<float>(p / cols, p % cols) : kNone, 0.0F))
            << "pixel " << p << ", size " << max_size;
      }
    }
  }
}

TEST(SpeckleFilter, SizeZeroIsOff) {
  const cv::Mat before = reference::randomDisparity(9, 9, 0.0, 50.0, 0.3, 2);
  cv::Mat after = before.clone();
  filterSpeckles(after, {0, 1.0});
  EXPECT_EQ(reference::differingPixels(after, before), 0);
}

TEST(SpeckleFilter, TakesAMapWithoutAnyDisparity) {
  cv::Mat none(4, 5, CV_32FC1, cv::Scalar(kNone));
  filterSpeckles(none, {10, 1.0});
  EXPECT_EQ(cv::countNonZero(none == none), 0);
}

}  // namespace
}  // namespace fdp_stereo
