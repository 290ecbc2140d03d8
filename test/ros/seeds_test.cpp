// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Seeds of other sensors: they arrive, and no fault of theirs stops the disparity.
#include <dynamic_reconfigure/config_tools.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_msgs/TFMessage.h>

#include "conversions.hpp"
#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using test::goodMessages;
using test::Inbox;
using test::kBaseline;
using test::kFocal;
using test::LogLines;
using test::Messages;
using test::nextStamp;
using test::NodeletGraph;
using test::waitUntil;

constexpr double kPlaneDepth = kFocal * kBaseline / test::kPlaneDisparity;

/// The plane as a LiDAR sees it that stands 1 m behind the left camera: z is larger by 1 m in its frame.
sensor_msgs::PointCloud2 lidarCloud(const ros::Time& stamp) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.frame_id = "lidar";
  cloud.header.stamp = stamp;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(100);
  sensor_msgs::PointCloud2Iterator<float> xyz(cloud, "x");
  for (int i = 0; i < 100; ++i, ++xyz) {
    xyz[0] = static_cast<float>((i % 10 - 5) * 0.1);
    xyz[1] = static_cast<float>((i / 10 - 5) * 0.1);
    xyz[2] = static_cast<float>(kPlaneDepth + 1.0);
  }
  return cloud;
}

class SeedTopics : public ::testing::Test {
 protected:
  SeedTopics() {
    points_ = graph_.node().advertise<sensor_msgs::PointCloud2>("seeds/points", 5);
    depth_ = graph_.node().advertise<sensor_msgs::Image>("seeds/depth", 5);
    depth_info_ = graph_.node().advertise<sensor_msgs::CameraInfo>("seeds/camera_info", 5);
    disparity_ = graph_.node().advertise<stereo_msgs::DisparityImage>("seeds/disparity", 5);
    tf_ = graph_.node().advertise<tf2_msgs::TFMessage>("/tf_static", 5, true);
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "left_optical";
    transform.child_frame_id = "lidar";
    transform.transform.translation.z = -1.0;
    transform.transform.rotation.w = 1.0;
    tf2_msgs::TFMessage message;
    message.transforms.push_back(transform);
    tf_.publish(message);
    EXPECT_TRUE(graph_.camera().waitForSubscribers(4));
    EXPECT_TRUE(waitUntil([&] {
      return points_.getNumSubscribers() >= 1 && depth_.getNumSubscribers() >= 1 &&
             disparity_.getNumSubscribers() >= 1 && depth_info_.getNumSubscribers() >= 1 &&
             tf_.getNumSubscribers() >= 1;
    }));
  }

  /// Sends pairs with whatever `send` adds at their stamp until the diagnostics tell so many seeds of other sensors.
  bool seedsArrive(const std::function<void(const ros::Time&)>& send, int least) {
    Messages messages = goodMessages();
    return waitUntil([&] {
      messages.stamp(nextStamp());
      send(messages.left.header.stamp);
      ros::WallDuration(0.02).sleep();
      graph_.camera().publish(messages);
      const auto enough = [&](const diagnostic_msgs::DiagnosticArray& array) { return seedsTold(array) >= least; };
      return diagnostics_.wait(enough, 0.2) != nullptr;
    });
  }

  static int seedsTold(const diagnostic_msgs::DiagnosticArray& array) {
    for (const auto& status : array.status) {
      for (const auto& entry : status.values) {
        if (entry.key == "Seeds of other sensors") return std::stoi(entry.value);
      }
    }
    return -1;
  }

  LogLines log_;
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics_{ros::NodeHandle(), "/diagnostics"};
  NodeletGraph graph_{"/fused"};
  ros::Publisher points_, depth_, depth_info_, disparity_, tf_;
};

TEST_F(SeedTopics, PointsThroughTf) {
  EXPECT_TRUE(seedsArrive([&](const ros::Time& stamp) { points_.publish(lidarCloud(stamp)); }, 90));
  EXPECT_TRUE(log_.lines().empty()) << log_.lines().front();
}

TEST_F(SeedTopics, DepthOfAQuarterOfTheResolution) {
  const auto send = [&](const ros::Time& stamp) {
    auto depth = test::imageMessage(cv::Mat(30, 40, CV_16UC1, cv::Scalar(1000.0 * kPlaneDepth)), "16UC1");
    auto info = test::cameraInfo(40, 30, kFocal / 4.0, 19.625, 14.625, 0.0);
    depth.header.stamp = info.header.stamp = stamp;
    depth_.publish(depth);
    depth_info_.publish(info);
  };
  EXPECT_TRUE(seedsArrive(send, 1000));
}

TEST_F(SeedTopics, DisparityOfAnotherMatcher) {
  const auto send = [&](const ros::Time& stamp) {
    std_msgs::Header header;
    header.stamp = stamp;
    const cv::Mat map(60, 80, CV_32FC1, cv::Scalar(test::kPlaneDisparity / 2.0));
    disparity_.publish(toDisparityMessage(map, header, {kFocal / 2.0, kBaseline, 0.0}, {0, 32}, 1.0));
  };
  EXPECT_TRUE(seedsArrive(send, 500));
}

TEST_F(SeedTopics, ASourceThatStopsOrIsLate) {
  ASSERT_TRUE(seedsArrive([&](const ros::Time& stamp) { points_.publish(lidarCloud(stamp)); }, 90));
  for (int i = 0; i < 3; ++i) nextStamp();
  EXPECT_TRUE(graph_.process(goodMessages()));
  EXPECT_NE(log_.wait({"/fused/seeds/points", "seeds_max_age", "stopped"}), "");
  points_.publish(lidarCloud(ros::Time(5.0)));
  EXPECT_TRUE(graph_.process(goodMessages()));
}

TEST_F(SeedTopics, NotANumberWrongFrameAndBrokenLayout) {
  const auto fails = [&](const std::function<void(sensor_msgs::PointCloud2&)>& spoil,
                         const std::vector<std::string>& said) {
    Messages messages = goodMessages();
    const bool heard = waitUntil([&] {
      messages.stamp(nextStamp());
      auto cloud = lidarCloud(messages.left.header.stamp);
      spoil(cloud);
      points_.publish(cloud);
      ros::WallDuration(0.02).sleep();
      graph_.camera().publish(messages);
      return !log_.wait(said, 0.1).empty();
    });
    EXPECT_TRUE(heard) << said.back();
    EXPECT_TRUE(graph_.process(goodMessages()));
  };
  fails([](auto& c) { c.header.frame_id = "elsewhere"; }, {"/fused/seeds/points", "no transform", "elsewhere"});
  fails([](auto& c) { c.data.resize(10); }, {"/fused/seeds/points", "too few"});
  fails([](auto& c) { std::fill(c.data.begin(), c.data.end(), 0xFF); }, {"/fused/seeds/points", "none of its points"});
}

TEST_F(SeedTopics, ASourceThatIsNotTrustedIsLeftOut) {
  graph_.edit(
      [](auto& config) { dynamic_reconfigure::ConfigTools::appendParameter(config, "seeds_points_trust", 0.0); });
  Messages messages = goodMessages();
  for (int i = 0; i < 5; ++i) {
    messages.stamp(nextStamp());
    points_.publish(lidarCloud(messages.left.header.stamp));
    ros::WallDuration(0.02).sleep();
    graph_.camera().publish(messages);
    EXPECT_TRUE(graph_.disparity().wait([&](const auto& d) { return d.header.stamp == messages.left.header.stamp; }));
  }
  EXPECT_FALSE(diagnostics_.wait([](const auto& array) { return seedsTold(array) > 0; }, 0.2));
}

TEST_F(SeedTopics, APairWaitsForSeedsOfItsTime) {
  graph_.edit([](auto& config) { dynamic_reconfigure::ConfigTools::appendParameter(config, "seeds_wait", 1.0); });
  Messages messages = goodMessages();
  points_.publish(lidarCloud(ros::Time(1.0)));  // heard once
  ros::WallDuration(0.1).sleep();
  messages.stamp(nextStamp());
  graph_.camera().publish(messages);
  ros::WallDuration(0.2).sleep();
  EXPECT_EQ(graph_.disparity().count(), 0U);
  points_.publish(lidarCloud(messages.left.header.stamp));
  EXPECT_TRUE(graph_.disparity().wait([&](const auto& d) { return d.header.stamp == messages.left.header.stamp; }));
  EXPECT_TRUE(diagnostics_.wait([](const auto& array) { return seedsTold(array) >= 90; }));
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "seeds_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
