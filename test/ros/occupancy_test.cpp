// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Images through both nodelets into maps, as their users fill them: points2 marks and clears, free_space clears, scan
// does both in a plane. A box appears, is marked, goes, is cleared.
#include <cmath>

#include <gtest/gtest.h>
#include <octomap/octomap.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "points_graph.hpp"

namespace fdp_stereo {
namespace {

using octomap::point3d;
using sensor_msgs::LaserScan;
using sensor_msgs::PointCloud2;
using test::Inbox;
using test::Messages;
using test::nextStamp;
using test::waitUntil;

constexpr int kBoxDisparity = 18;
constexpr double kBoxDepth = test::kFocal * test::kBaseline / kBoxDisparity;
constexpr double kRangeMax = 1.7;  // before the wall
constexpr double kCell = 0.05;     // m

/// The wall behind a box at kPatch of the left image; blank: instead of the box a patch of the wall without texture.
const cv::Rect kPatch(60, 40, 40, 40);
enum class Scene { kEmpty, kBox, kBlankPatch };

Messages pairOf(Scene scene) {
  const test::PlanePair wall = test::planePair(160, 120, test::kPlaneDisparity);
  const test::PlanePair front = test::planePair(160, 120, kBoxDisparity, 7);
  const cv::Rect in_right = kPatch - cv::Point(scene == Scene::kBox ? kBoxDisparity : test::kPlaneDisparity, 0);
  if (scene == Scene::kBox) {
    front.left(kPatch).copyTo(wall.left(kPatch));
    front.left(kPatch).copyTo(wall.right(in_right));
  } else if (scene == Scene::kBlankPatch) {
    wall.left(kPatch).setTo(128);
    wall.right(in_right).setTo(128);
  }
  Messages messages = test::goodMessages();
  messages.left = test::imageMessage(wall.left, "mono8");
  messages.right = test::imageMessage(wall.right, "mono8");
  return messages;
}

octomap::Pointcloud known(const PointCloud2& message) {
  octomap::Pointcloud cloud;
  for (sensor_msgs::PointCloud2ConstIterator<float> p(message, "x"); p != p.end(); ++p) {
    if (!std::isnan(p[2])) cloud.push_back(p[0], p[1], p[2]);
  }
  return cloud;
}

/// What a user of octomap does with a cloud that only clears.
void clearRays(const octomap::Pointcloud& ends, octomap::OcTree& map) {
  octomap::KeySet free;
  octomap::KeyRay ray;
  for (const point3d& end : ends) {
    if (map.computeRayKeys(point3d(0, 0, 0), end, ray)) free.insert(ray.begin(), ray.end());
  }
  for (const octomap::OcTreeKey& key : free) map.updateNode(key, false);
}

/// What costmap_2d does with a scan: ranges below range_max clear, those below obstacle_range mark.
void addScan(const LaserScan& scan, octomap::OcTree& map) {
  const double obstacle_range = kRangeMax - 0.1;
  octomap::Pointcloud hits;
  octomap::Pointcloud clear;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const float range = scan.ranges[i];
    if (!(range >= scan.range_min && range < scan.range_max)) continue;
    const double bearing = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const point3d end(static_cast<float>(range * std::cos(bearing)), static_cast<float>(range * std::sin(bearing)), 0);
    (range < obstacle_range ? hits : clear).push_back(end);
  }
  clearRays(clear, map);
  map.insertPointCloud(hits, point3d(0, 0, 0));
}

enum class Cell { kUnknown, kFree, kOccupied };

Cell cellAt(const octomap::OcTree& map, const point3d& place) {
  const octomap::OcTreeNode* node = map.search(place);
  if (node == nullptr) return Cell::kUnknown;
  return map.isNodeOccupied(node) ? Cell::kOccupied : Cell::kFree;
}

class Occupancy : public ::testing::Test {
 protected:
  struct Outputs {
    sensor_msgs::PointCloud2ConstPtr points, free_space;
    sensor_msgs::LaserScanConstPtr scan;
  };

  /// Sends a pair as a camera does until all has come that follows from it.
  Outputs process(Messages messages) {
    const ros::Time first = nextStamp();
    const auto new_enough = [&](const auto& m) { return m.header.stamp >= first; };
    Outputs outputs;
    messages.stamp(first);
    waitUntil([&] {
      graph_.camera().publish(messages);
      messages.stamp(nextStamp());
      outputs = {points_.wait(new_enough, 0.3), free_space_.wait(new_enough, 0.3), scan_.wait(new_enough, 0.3)};
      return outputs.points && outputs.free_space && outputs.scan;
    });
    return outputs;
  }

  /// Twenty frames of a scene into both maps.
  void see(Scene scene) {
    const Messages messages = pairOf(scene);
    for (int i = 0; i < 20; ++i) {
      const Outputs outputs = process(messages);
      ASSERT_TRUE(outputs.points && outputs.free_space && outputs.scan);
      clearRays(known(*outputs.free_space), room_);
      room_.insertPointCloud(known(*outputs.points), point3d(0, 0, 0));
      addScan(*outputs.scan, plane_);
    }
  }
  Cell inRoom() const { return cellAt(room_, point3d(0, 0, static_cast<float>(kBoxDepth))); }
  Cell inPlane() const { return cellAt(plane_, point3d(static_cast<float>(kBoxDepth), 0, 0)); }

  test::CameraOnBase camera_;
  test::NodeletGraph graph_{"/robot"};
  test::PointsNodeletHost host_{"/robot", {{"scan_range_max", kRangeMax}}};
  Inbox<PointCloud2> points_{graph_.node(), "points2"};
  Inbox<PointCloud2> free_space_{graph_.node(), "free_space"};
  Inbox<LaserScan> scan_{graph_.node(), "scan"};
  octomap::OcTree room_{kCell};   ///< in the frame of the camera
  octomap::OcTree plane_{kCell};  ///< in the frame of the scan
};

TEST_F(Occupancy, ABoxAppearsAndGoes) {
  see(Scene::kEmpty);
  EXPECT_EQ(inRoom(), Cell::kFree);
  EXPECT_EQ(inPlane(), Cell::kFree);
  see(Scene::kBox);
  EXPECT_EQ(inRoom(), Cell::kOccupied);
  EXPECT_EQ(inPlane(), Cell::kOccupied);
  see(Scene::kEmpty);
  EXPECT_EQ(inRoom(), Cell::kFree);
  EXPECT_EQ(inPlane(), Cell::kFree);
}

TEST_F(Occupancy, WhatGoesIsClearedWhereNothingIsAnswered) {
  see(Scene::kBox);
  ASSERT_EQ(inRoom(), Cell::kOccupied);
  see(Scene::kBlankPatch);
  EXPECT_EQ(inRoom(), Cell::kFree);
  EXPECT_EQ(inPlane(), Cell::kFree);
}

/// Rays of free_space alone, again and again, leave all of the box that points2 marked.
TEST_F(Occupancy, FreeSpaceClearsNothingThatIsThere) {
  see(Scene::kBox);
  for (int i = 0; i < 50; ++i) {
    const Outputs outputs = process(pairOf(Scene::kBox));
    ASSERT_TRUE(outputs.free_space);
    clearRays(known(*outputs.free_space), room_);
  }
  for (double x = -0.08; x < 0.09; x += kCell) {
    for (double y = -0.05; y < 0.06; y += kCell) {
      EXPECT_EQ(cellAt(room_, point3d(static_cast<float>(x), static_cast<float>(y), static_cast<float>(kBoxDepth))),
                Cell::kOccupied)
          << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "occupancy_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
