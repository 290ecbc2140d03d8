// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// stereo.launch alone: it brings its own manager, and the log says what the node takes and how near it sees.
#include <gtest/gtest.h>

#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using rosgraph_msgs::Log;
using stereo_msgs::DisparityImage;
using test::Camera;
using test::goodMessages;
using test::Inbox;
using test::Messages;
using test::nextStamp;

boost::shared_ptr<const DisparityImage> waitForDisparity(Inbox<DisparityImage>& disparity,
                                                         const std::function<void(const Messages&)>& publish) {
  Messages messages = goodMessages();
  for (int i = 0; i < 200; ++i) {
    messages.stamp(nextStamp());
    publish(messages);
    if (auto found = disparity.wait([](const auto&) { return true; }, 0.3)) return found;
  }
  return nullptr;
}

TEST(Launch, NearestSetsTheRangeOnce) {
  Inbox<Log> log(ros::NodeHandle(), "/rosout");
  Camera camera("/rectified");
  Inbox<DisparityImage> disparity(ros::NodeHandle("/rectified"), "disparity");
  ASSERT_TRUE(camera.waitForSubscribers(4));
  ASSERT_TRUE(test::waitUntil([&] { return log.publishers() > 2; })) << "the two managers and this one";
  const auto image = waitForDisparity(disparity, [&](const Messages& messages) { camera.publish(messages); });
  ASSERT_TRUE(image);
  EXPECT_FLOAT_EQ(image->max_disparity, 111.0F) << "200 px x 0.1 m / 0.2 m, and up to a multiple of 16";
  EXPECT_EQ(ros::param::param("/rectified/disparity/disparity_range", 0), 112);
  const std::string expected = "/rectified/left/image_rect (160 x 120 px, 8 bit): sees from 0.18 m";
  EXPECT_TRUE(log.wait([&](const Log& line) { return line.msg.find(expected) != std::string::npos; }));

  dynamic_reconfigure::Reconfigure call;
  call.request.config.ints.resize(1);
  call.request.config.ints[0].name = "disparity_range";
  call.request.config.ints[0].value = 32;
  ASSERT_TRUE(ros::service::call("/rectified/disparity/set_parameters", call));
  disparity.clear();
  const ros::Time edited = nextStamp();
  Messages messages = goodMessages();
  messages.stamp(edited);
  camera.publish(messages);
  const auto next = disparity.wait([&](const auto& d) { return d.header.stamp == edited; });
  ASSERT_TRUE(next);
  EXPECT_FLOAT_EQ(next->max_disparity, 31.0F) << "an edit holds";
}

TEST(Launch, RawImagesOfAnyName) {
  ros::NodeHandle node("/raw");
  auto left = node.advertise<sensor_msgs::Image>("cam0/image", 10);
  auto right = node.advertise<sensor_msgs::Image>("cam1/image", 10);
  auto left_info = node.advertise<sensor_msgs::CameraInfo>("cam0/camera_info", 10);
  auto right_info = node.advertise<sensor_msgs::CameraInfo>("cam1/camera_info", 10);
  Inbox<DisparityImage> disparity(node, "disparity");
  const auto image = waitForDisparity(disparity, [&](const Messages& messages) {
    left_info.publish(messages.left_info);
    right_info.publish(messages.right_info);
    left.publish(messages.left);
    right.publish(messages.right);
  });
  ASSERT_TRUE(image);
  EXPECT_FLOAT_EQ(image->max_disparity, 47.0F);
  EXPECT_EQ(ros::param::param<std::string>("/raw/disparity/preset", ""), "light");
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "launch_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
