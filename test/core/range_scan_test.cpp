// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/range_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace {

constexpr double kCameraHeight = 0.5;  // m
constexpr int kSpacing = 8;

/// A camera that looks along x of the frame of the scan, level, 0.5 m above its origin.
Eigen::Isometry3d scanFromCamera(double yaw = 0.0) {
  Eigen::Matrix3d optical;
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix() * optical;
  place.translation() = Eigen::Vector3d(0.0, 0.0, kCameraHeight);
  return place;
}

/// A floor, and a wall at wall_m; every pixel is answered.
SeenDepth room(double wall_m) {
  SeenDepth seen{{200.0, 200.0, 79.5, 59.5, {160, 120}}, {}, {}, kSpacing, 0.0};
  seen.depth = cv::Mat(120, 160, CV_32FC1);
  for (int v = 0; v < 120; ++v) {
    const double down = (v - 59.5) / 200.0;
    const double floor_m = down > 0.0 ? kCameraHeight / down : 1e9;
    seen.depth.row(v).setTo(std::min(floor_m, wall_m));
  }
  seen.free_depth = cv::Mat(15, 20, CV_32FC1, cv::Scalar(kInvalidDisparity));
  return seen;
}

float straightAhead(const RangeScan& scan) {
  return scan.ranges[static_cast<std::size_t>(-scan.first_bearing / scan.increment)];
}

TEST(RangeScan, AWallIsMeasuredFromTheFrame) {
  const RangeScan scan = scanRanges(room(3.0), scanFromCamera(), {});
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double bearing = scan.first_bearing + scan.increment * (static_cast<double>(i) + 0.5);
    EXPECT_NEAR(scan.ranges[i], 3.0 / std::cos(bearing), 0.02) << bearing;
  }
  EXPECT_NEAR(scan.first_bearing, -std::atan2(79.5, 200.0), 1e-9);
}

TEST(RangeScan, BeyondTheRangeItIsFree) {
  const RangeScan scan = scanRanges(room(9.0), scanFromCamera(), {});
  for (const float range : scan.ranges) EXPECT_EQ(range, 5.0F);
}

TEST(RangeScan, WhatIsNotAnsweredIsNotKnownUnlessItsRayIsFree) {
  SeenDepth seen = room(9.0);
  seen.depth(cv::Rect(64, 48, 32, 24)).setTo(kInvalidDisparity);
  EXPECT_TRUE(std::isnan(straightAhead(scanRanges(seen, scanFromCamera(), {}))));
  seen.free_depth(cv::Rect(8, 6, 4, 3)).setTo(4.0F);
  EXPECT_TRUE(std::isnan(straightAhead(scanRanges(seen, scanFromCamera(), {})))) << "free, but not far enough";
  seen.free_depth(cv::Rect(8, 6, 4, 3)).setTo(6.0F);
  EXPECT_EQ(straightAhead(scanRanges(seen, scanFromCamera(), {})), 5.0F);
}

TEST(RangeScan, AnObstacleIsToldWhateverElseIsNotKnown) {
  SeenDepth seen = room(9.0);
  seen.depth(cv::Rect(64, 48, 32, 24)).setTo(kInvalidDisparity);
  seen.depth(cv::Rect(70, 50, 20, 5)).setTo(2.0F);
  EXPECT_NEAR(straightAhead(scanRanges(seen, scanFromCamera(), {})), 2.0, 0.01);
}

TEST(RangeScan, AnUnseenStripLeavesTheOtherBearingsFree) {
  for (const double forward : {0.0, 0.2}) {
    SeenDepth seen = room(9.0);
    seen.depth.colRange(0, 16).setTo(kInvalidDisparity);
    seen.nearest = 0.5;
    Eigen::Isometry3d place = scanFromCamera();
    place.translation().x() = forward;
    const RangeScan scan = scanRanges(seen, place, {});
    EXPECT_EQ(straightAhead(scan), 5.0F) << forward;
    EXPECT_TRUE(std::isnan(scan.ranges.back())) << "the left end";
    EXPECT_EQ(scan.ranges[scan.ranges.size() * 3 / 4], 5.0F);
  }
}

TEST(RangeScan, OnlyWhatIsBetweenTheHeightsCounts) {
  const SeenDepth seen = room(3.0);
  RangeScanParams high;
  high.min_height_m = 2.0;
  high.max_height_m = 3.0;
  for (const float range : scanRanges(seen, scanFromCamera(), high).ranges) {
    EXPECT_TRUE(std::isnan(range)) << "the camera does not see so high within the range";
  }
  RangeScanParams floor;
  floor.min_height_m = -0.1;
  EXPECT_LT(straightAhead(scanRanges(seen, scanFromCamera(), floor)), 2.0F);
}

TEST(RangeScan, BearingsDoNotJumpBehindTheRobot) {
  const RangeScan scan = scanRanges(room(3.0), scanFromCamera(3.1), {});
  EXPECT_LT(scan.ranges.size(), 90U);
  for (const float range : scan.ranges) EXPECT_LT(range, 3.5F);
}

TEST(RangeScan, NoRayIsLeftOutBetweenSquares) {
  RangeScanParams fine;
  fine.increment_rad = 0.002;
  const RangeScan scan = scanRanges(room(9.0), scanFromCamera(), fine);
  EXPECT_EQ(std::count(scan.ranges.begin(), scan.ranges.end(), 5.0F), static_cast<int>(scan.ranges.size()));
}

TEST(RangeScan, ACameraWithoutAFocalLengthSeesNothing) {
  SeenDepth seen = room(3.0);
  seen.camera.fx = 1e-310;
  const RangeScan scan = scanRanges(seen, scanFromCamera(), {});
  for (const float range : scan.ranges) EXPECT_TRUE(std::isnan(range));
}

TEST(RangeScan, PointsThatAreNoNumbersAreNoObstacles) {
  Eigen::Isometry3d nowhere = scanFromCamera();
  nowhere.translation().x() = std::numeric_limits<double>::quiet_NaN();
  Eigen::Isometry3d turned_by_nothing = scanFromCamera();
  turned_by_nothing.linear().setConstant(std::numeric_limits<double>::quiet_NaN());
  for (const Eigen::Isometry3d& place : {nowhere, turned_by_nothing}) {
    const RangeScan scan = scanRanges(room(3.0), place, {});
    for (const float range : scan.ranges) EXPECT_TRUE(std::isnan(range)) << range;
  }
}

TEST(RangeScan, ACameraThatLooksStraightDown) {
  Eigen::Isometry3d down = Eigen::Isometry3d::Identity();
  down.linear() = Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()).toRotationMatrix();
  down.translation() = Eigen::Vector3d(0.0, 0.0, 0.5);
  const RangeScan scan = scanRanges(room(3.0), down, {});
  EXPECT_FALSE(scan.ranges.empty());
}

}  // namespace
}  // namespace fdp_stereo
