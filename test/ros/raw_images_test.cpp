// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// rectify = internal: raw images go in, and what comes out is what process_bag --rectify gives, to the bit.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/PointCloud2.h>

#include "conversions.hpp"
#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;
using sensor_msgs::Image;
using stereo_msgs::DisparityImage;
using test::Inbox;
using test::LogLines;
using test::Messages;
using test::NodeletGraph;

/// The disparity that process_bag finds in a recording of this pair.
stereo_msgs::DisparityImageConstPtr processBag(const Messages& messages) {
  const fs::path folder = fs::temp_directory_path() / "fdp_stereo_raw_images_test";
  fs::remove_all(folder);
  fs::create_directory(folder);
  rosbag::Bag bag((folder / "raw.bag").string(), rosbag::bagmode::Write);
  const ros::Time stamp = messages.left.header.stamp;
  bag.write("/stereo/left/camera_info", stamp, messages.left_info);
  bag.write("/stereo/right/camera_info", stamp, messages.right_info);
  bag.write("/stereo/left/image_raw", stamp, messages.left);
  bag.write("/stereo/right/image_raw", stamp, messages.right);
  bag.close();
  const std::string command = FDP_STEREO_TOOL_DIR "/process_bag --rectify --num-disparities 32 " +
                              (folder / "raw.bag").string() + " " + (folder / "out.bag").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
  bag.open((folder / "out.bag").string());
  rosbag::View view(bag, rosbag::TopicQuery("/stereo/disparity"));
  stereo_msgs::DisparityImageConstPtr disparity;
  for (const auto& message : view) disparity = message.instantiate<DisparityImage>();
  bag.close();
  fs::remove_all(folder);
  return disparity;
}

double shareAt(const DisparityImage& message, double disparity) {
  const cv::Mat map = fromDisparityMessage(message, {}, "disparity");
  return cv::countNonZero(cv::abs(map - disparity) < 0.5) / static_cast<double>(cv::countNonZero(map == map));
}

TEST(RawImages, GiveWhatProcessBagGives) {
  NodeletGraph graph("/raw", {{"rectify", "internal"}});
  const Messages messages = test::rawMessages();
  const auto disparity = graph.process(messages);
  ASSERT_TRUE(disparity);
  const auto expected = processBag(messages);
  ASSERT_TRUE(expected);
  EXPECT_EQ(disparity->image.data, expected->image.data);
  EXPECT_EQ(disparity->f, expected->f);
  EXPECT_GT(shareAt(*disparity, test::kPlaneDisparity), 0.99);
}

TEST(RawImages, TheRectifiedLeftImageIsAnOutput) {
  NodeletGraph graph("/output", {{"rectify", "internal"}});
  ASSERT_TRUE(graph.process(test::rawMessages()));
  Inbox<Image> rectified(graph.node(), "left/image_rect");
  const auto has_size = [](const Image& image) { return image.width == 240 && image.encoding == "mono8"; };
  EXPECT_FALSE(rectified.wait(has_size, 0.2)) << "nothing was sent";
  EXPECT_TRUE(test::waitUntil([&] {
    graph.process(test::rawMessages());
    return rectified.wait(has_size, 0.2) != nullptr;
  }));
  graph.disparity().close();
  rectified.clear();
  Messages messages = test::rawMessages();
  EXPECT_TRUE(test::waitUntil([&] {
    messages.stamp(test::nextStamp());
    graph.camera().publish(messages);
    return rectified.wait(has_size, 0.3) != nullptr;
  })) << "alone, too";
}

TEST(RawImages, RectifiedOnesAreTakenAsTheyAre) {
  NodeletGraph graph("/rectified", {{"rectify", "internal"}});
  NodeletGraph usual("/usual");
  const auto disparity = graph.process(test::goodMessages());
  const auto expected = usual.process(test::goodMessages());
  ASSERT_TRUE(disparity && expected);
  EXPECT_EQ(disparity->image.data, expected->image.data);
}

TEST(RawImages, AnUnknownWayToRectifyIsSaid) {
  LogLines log;
  const NodeletGraph graph("/unknown", {{"rectify", "externl"}});
  EXPECT_NE(log.wait({"~rectify = 'externl'", "internal", "none"}), "");
}

TEST(RawImages, BadCalibrationsAreSaidAndRecoveredFrom) {
  struct Bad {
    std::function<void(Messages&)> spoil;
    std::vector<std::string> said;
  };
  const Bad table[] = {
      {[](Messages& m) { m.left_info.D[0] = 0.0 / 0.0; }, {"/bad/left/camera_info", "D[0] ="}},
      {[](Messages& m) { m.right_info.K.fill(0.0); }, {"/bad/right/camera_info", "K[0] = 0"}},
      {[](Messages& m) { m.right_info.R.fill(2.0); }, {"/bad/right/camera_info", "no rotation"}},
      {[](Messages& m) { m.left_info.distortion_model = "fisheye"; }, {"/bad/left/camera_info", "'fisheye'"}},
      {[](Messages& m) { m.left_info.P[2] = -9e5; }, {"/bad/left/camera_info", "shows nothing"}},
      {[](Messages& m) { m.left_info.width = 320; }, {"/bad/left/camera_info", "320 x 180"}},
      {[](Messages& m) { m.left.data.resize(5); }, {"/bad/left/image_raw", "truncated"}},
  };
  NodeletGraph graph("/bad", {{"rectify", "internal"}});
  for (const Bad& bad : table) {
    LogLines log;
    Messages messages = test::rawMessages();
    bad.spoil(messages);
    EXPECT_FALSE(graph.process(messages, 0.5));
    EXPECT_NE(log.wait(bad.said, 5.0), "") << bad.said[1];
    EXPECT_TRUE(graph.process(test::rawMessages())) << "recovers";
  }
}

TEST(RawImages, StereoLaunchMakesPointsOfThem) {
  test::Camera camera("/launched", "image_raw");
  Inbox<sensor_msgs::PointCloud2> points(ros::NodeHandle("/launched"), "points2");
  Messages messages = test::rawMessages();
  const auto fits = [](const sensor_msgs::PointCloud2& cloud) { return cloud.width == 240 && cloud.height == 180; };
  EXPECT_TRUE(test::waitUntil([&] {
    messages.stamp(test::nextStamp());
    camera.publish(messages);
    return points.wait(fits, 0.3) != nullptr;
  }));
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "raw_images_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
