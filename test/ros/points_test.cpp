// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// stereo.launch's points2 of a plane at a known distance, for parallel and for verged cameras.
#include <cmath>

#include <XmlRpcClient.h>
#include <gtest/gtest.h>
#include <ros/master.h>
#include <ros/network.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using test::Camera;
using test::goodMessages;
using test::Inbox;
using test::kBaseline;
using test::kFocal;
using test::kPlaneDisparity;
using test::Messages;
using test::nextStamp;

sensor_msgs::PointCloud2ConstPtr pointsOf(Camera& camera, Inbox<sensor_msgs::PointCloud2>& points, Messages messages) {
  EXPECT_TRUE(camera.waitForSubscribers(6)) << "disparity, and points the left image and its info";
  for (int i = 0; i < 100; ++i) {
    messages.stamp(nextStamp());
    const ros::Time stamp = messages.left.header.stamp;
    camera.publish(messages);
    if (const auto cloud = points.wait([&](const auto& c) { return c.header.stamp >= stamp; }, 0.3)) return cloud;
  }
  return nullptr;
}

/// The points of the pixels around `centre`, px.
struct Measured {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

Measured meanAround(const sensor_msgs::PointCloud2& cloud, int centre_x, int centre_y) {
  constexpr int kRadius = 10;
  Measured mean;
  int count = 0;
  sensor_msgs::PointCloud2ConstIterator<float> xyz(cloud, "x");
  for (int v = 0; v < static_cast<int>(cloud.height); ++v) {
    for (int u = 0; u < static_cast<int>(cloud.width); ++u, ++xyz) {
      if (std::abs(u - centre_x) > kRadius || std::abs(v - centre_y) > kRadius || !std::isfinite(xyz[2])) continue;
      mean.x += xyz[0];
      mean.y += xyz[1];
      mean.z += xyz[2];
      ++count;
    }
  }
  EXPECT_GT(count, 200);
  return {mean.x / count, mean.y / count, mean.z / count};
}

void expectPlane(const sensor_msgs::PointCloud2& cloud, double disparity) {
  const double z = kFocal * kBaseline / disparity;
  const Measured mean = meanAround(cloud, 120, 40);  // the principal point is (80, 60)
  EXPECT_NEAR(mean.z, z, 0.01 * z);
  EXPECT_NEAR(mean.x, 40.0 * z / kFocal, 0.01 * z);
  EXPECT_NEAR(mean.y, -20.0 * z / kFocal, 0.01 * z);
}

TEST(Points, PlaneOfParallelCameras) {
  Camera camera("/parallel");
  Inbox<sensor_msgs::PointCloud2> points(ros::NodeHandle("/parallel"), "points2");
  const auto cloud = pointsOf(camera, points, goodMessages());
  ASSERT_TRUE(cloud);
  expectPlane(*cloud, kPlaneDisparity);
}

TEST(Points, PlaneOfVergedCameras) {
  Messages messages = goodMessages();
  messages.right_info.P[2] += 20.0;
  Camera camera("/verged");
  Inbox<sensor_msgs::PointCloud2> points(ros::NodeHandle("/verged"), "points2");
  const auto cloud = pointsOf(camera, points, messages);
  ASSERT_TRUE(cloud);
  expectPlane(*cloud, kPlaneDisparity + 20.0);
}

/// Ends a node by its own API, as rosnode kill does.
void killNode(const std::string& name) {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue payload;
  request[0] = ros::this_node::getName();
  request[1] = name;
  ASSERT_TRUE(ros::master::execute("lookupNode", request, response, payload, false));
  std::string host;
  std::uint32_t port = 0;
  ASSERT_TRUE(ros::network::splitURI(static_cast<std::string>(payload), host, port));
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue shutdown;
  shutdown[0] = ros::this_node::getName();
  shutdown[1] = "test";
  ASSERT_TRUE(client.execute("shutdown", shutdown, response));
}

TEST(Points, AConsumerThatEndsLeavesTheManagerAlone) {
  Camera camera("/parallel");
  Inbox<stereo_msgs::DisparityImage> disparity(ros::NodeHandle("/parallel"), "disparity");
  ASSERT_TRUE(camera.waitForSubscribers(4));
  killNode("/parallel/points");
  Messages messages = goodMessages();
  messages.stamp(nextStamp());
  camera.publish(messages);
  EXPECT_TRUE(disparity.wait([&](const auto& d) { return d.header.stamp == messages.left.header.stamp; }));
}

/// The last test: without its manager the loader says so and ends.
TEST(Points, AManagerThatDiesIsTold) {
  Inbox<rosgraph_msgs::Log> log(ros::NodeHandle(), "/rosout");
  ASSERT_TRUE(test::waitUntil([&] { return log.publishers() > 5; }));
  killNode("/stereo_manager");
  EXPECT_TRUE(log.wait([](const auto& line) {
    return line.name == "/parallel/disparity" && line.msg.find("Bond broken") != std::string::npos;
  }));
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "points_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
