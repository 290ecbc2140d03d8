// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_messages.hpp"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "point_scene.hpp"

namespace fdp_stereo {
namespace {

using test::errorOf;
using test::expectContains;
using test::PointScene;

PointView decode(const PointScene& scene, const PointParams& params = {}) {
  std::vector<std::string> warnings;
  return decodePointFrame(scene.frame(), params, {}, warnings);
}

/// The values of a field in the order of the pixels.
std::vector<float> field(const sensor_msgs::PointCloud2& cloud, const std::string& name) {
  std::vector<float> values;
  for (sensor_msgs::PointCloud2ConstIterator<float> it(cloud, name); it != it.end(); ++it) values.push_back(*it);
  return values;
}

std::size_t known(const std::vector<float>& values) {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](float value) { return !std::isnan(value); }));
}

TEST(PointMessages, APointPerPixel) {
  PointScene scene;
  const auto cloud = toPointCloud(decode(scene), 1);
  ASSERT_EQ(cloud->width, 160U);
  ASSERT_EQ(cloud->height, 120U);
  EXPECT_EQ(cloud->point_step, 24U);
  EXPECT_EQ(cloud->header.frame_id, "left_optical");
  const std::size_t pixel = 30 * 160 + 100;
  const double z = test::kFocal * test::kBaseline / test::kPlaneDisparity;
  EXPECT_NEAR(field(*cloud, "z")[pixel], z, 1e-5);
  EXPECT_NEAR(field(*cloud, "x")[pixel], 20.0 * z / test::kFocal, 1e-5);
  EXPECT_NEAR(field(*cloud, "y")[pixel], -30.0 * z / test::kFocal, 1e-5);
  EXPECT_FLOAT_EQ(field(*cloud, "confidence")[pixel], 0.9F);
  EXPECT_FLOAT_EQ(field(*cloud, "depth_error")[pixel], 0.02F);
  std::uint32_t rgb = 0;
  const float packed = field(*cloud, "rgb")[pixel];
  std::memcpy(&rgb, &packed, sizeof(rgb));
  EXPECT_EQ(rgb, 0x4D4D4DU);
}

TEST(PointMessages, ACameraBesideTheOriginOfItsFrame) {
  PointScene scene;
  scene.info.P[3] = -test::kFocal * 0.05;
  const auto beside = field(*toPointCloud(decode(scene), 1), "x");
  const auto at_origin = field(*toPointCloud(decode(PointScene()), 1), "x");
  EXPECT_NEAR(beside[200] - at_origin[200], 0.05, 1e-5);
}

TEST(PointMessages, LimitsLeaveOutUnsurePoints) {
  PointScene scene;
  scene.confidence(cv::Rect(0, 0, 80, 120)).setTo(0.3F);
  scene.depth_error(cv::Rect(0, 0, 160, 60)).setTo(0.5F);
  scene.depth_error(cv::Rect(0, 60, 160, 10)).setTo(std::nanf(""));
  EXPECT_EQ(known(field(*toPointCloud(decode(scene, {1, 0.5}), 1), "z")), 80U * 120U);
  EXPECT_EQ(known(field(*toPointCloud(decode(scene, {1, 0.0, 0.1}), 1), "z")), 160U * 50U);
  EXPECT_EQ(known(field(*toPointCloud(decode(scene, {1, 0.0, 0.0, 2.0}), 1), "z")), 0U);
  EXPECT_EQ(known(field(*toPointCloud(decode(scene, {1, 0.0, 0.0, 3.0}), 1), "z")), 160U * 120U);
}

TEST(PointMessages, LimitsWithoutTheirTopicAreTold) {
  PointScene scene;
  PointFrame frame = scene.frame();
  frame.confidence.reset();
  frame.depth_error.reset();
  std::vector<std::string> warnings;
  const PointView view = decodePointFrame(frame, {1, 0.5, 0.1}, {}, warnings);
  ASSERT_EQ(warnings.size(), 2U);
  expectContains(warnings[0], {"min_confidence = 0.5", "confidence"});
  expectContains(warnings[1], {"max_depth_error = 0.1", "depth_error"});
  EXPECT_EQ(known(field(*toPointCloud(view, 1), "z")), 160U * 120U);
}

TEST(PointMessages, TheBestPointOfASquare) {
  PointScene scene;
  scene.disparity(cv::Rect(0, 0, 8, 8)).setTo(kInvalidDisparity);
  scene.confidence.at<float>(9, 10) = 1.0F;
  const auto cloud = toPointCloud(decode(scene), 8);
  ASSERT_EQ(cloud->width, 20U);
  ASSERT_EQ(cloud->height, 15U);
  EXPECT_TRUE(std::isnan(field(*cloud, "z")[0]));
  EXPECT_EQ(known(field(*cloud, "z")), 299U);
  EXPECT_FLOAT_EQ(field(*cloud, "confidence")[21], 1.0F);
}

TEST(PointMessages, NoPointWithoutDisparity) {
  PointScene scene;
  scene.disparity.setTo(kInvalidDisparity);
  EXPECT_EQ(known(field(*toPointCloud(decode(scene), 1), "z")), 0U);
  const PointView view = decode(scene);
  EXPECT_EQ(known(field(*toFreeSpaceCloud(view, freeDepth(view)), "z")), 0U);
}

TEST(PointMessages, FreeSpaceEndsBeforeTheSurface) {
  const PointView view = decode(PointScene());
  const auto cloud = toFreeSpaceCloud(view, freeDepth(view));
  ASSERT_EQ(cloud->width, 20U);
  const double z = test::kFocal * test::kBaseline / (test::kPlaneDisparity + 1.0);
  for (const float depth : field(*cloud, "z")) EXPECT_NEAR(depth, z, 1e-5);
}

TEST(PointMessages, WhatIsUnsureIsNotFree) {
  PointScene scene;
  scene.confidence.setTo(0.5F);
  const PointView view = decode(scene);
  EXPECT_EQ(known(field(*toFreeSpaceCloud(view, freeDepth(view)), "z")), 0U);
  EXPECT_EQ(known(field(*toPointCloud(view, 1), "z")), 160U * 120U) << "but an obstacle";
}

TEST(PointMessages, AFreeBearingIsBelowRangeMax) {
  const PointView view = decode(PointScene());
  RangeScanParams near;
  near.max_range_m = 2.0;
  const auto scan = toLaserScan(view, freeDepth(view), test::baseFromCamera(), "base_link", near);
  EXPECT_EQ(scan->header.frame_id, "base_link");
  ASSERT_FALSE(scan->ranges.empty());
  EXPECT_NEAR(scan->angle_max - scan->angle_min, scan->angle_increment * static_cast<double>(scan->ranges.size() - 1),
              1e-4);
  const float middle = scan->ranges[scan->ranges.size() / 2];
  EXPECT_EQ(middle, std::nextafter(2.0F, 0.0F));
  EXPECT_LT(middle, scan->range_max) << "which laser_geometry, and so costmap_2d, requires";
  const auto far = toLaserScan(view, freeDepth(view), test::baseFromCamera(), "base_link", {});
  EXPECT_NEAR(far->ranges[far->ranges.size() / 2], 20.0 / 9.0, 0.01);
}

TEST(PointMessages, BadInputIsNamed) {
  struct Bad {
    std::function<void(PointFrame&)> spoil;
    std::vector<std::string> said;
  };
  for (const Bad& bad : test::badPointFrames<Bad>()) {
    PointFrame frame = PointScene().frame();
    bad.spoil(frame);
    std::vector<std::string> warnings;
    expectContains(errorOf([&] { decodePointFrame(frame, {}, {}, warnings); }), bad.said);
  }
}

}  // namespace
}  // namespace fdp_stereo
