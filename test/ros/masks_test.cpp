// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The robot's arm is seen by both cameras and moves under their masks.
#include <filesystem>

#include <gtest/gtest.h>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using test::imageMessage;
using test::LogLines;
using test::Messages;
using test::NodeletGraph;

const cv::Rect kArm(50, 60, 60, 60);

cv::Mat maskImage() {
  cv::Mat mask(120, 160, CV_8UC1, cv::Scalar(0));
  mask(kArm).setTo(255);
  return mask;
}

/// The plane with an arm before it, textured, in another place for every number.
Messages pairWithArm(int number) {
  const test::PlanePair pair = test::planePair(160, 120, test::kPlaneDisparity);
  const test::PlanePair arm = test::planePair(160, 120, 20, 7U + static_cast<unsigned>(number));
  const cv::Rect part(kArm.x + 8 * number, kArm.y + 6 * number, 30, 20);
  arm.left(part).copyTo(pair.left(part));
  arm.right(part).copyTo(pair.right(part));
  Messages messages = test::goodMessages();
  messages.left = imageMessage(pair.left, "mono8");
  messages.right = imageMessage(pair.right, "mono8");
  return messages;
}

bool knownUnderTheMask(const stereo_msgs::DisparityImage& disparity) {
  const cv::Mat map = fromDisparityMessage(disparity, {}, "disparity");
  return cv::countNonZero(map(kArm) == map(kArm)) > 0;
}

std::size_t known(const stereo_msgs::DisparityImage& disparity) {
  const cv::Mat map = fromDisparityMessage(disparity, {}, "disparity");
  return static_cast<std::size_t>(cv::countNonZero(map == map));
}

void expectThatAnArmChangesNothing(NodeletGraph& graph) {
  const auto first = graph.process(pairWithArm(0));
  ASSERT_TRUE(first);
  EXPECT_FALSE(knownUnderTheMask(*first));
  EXPECT_GT(known(*first), 160U * 120U / 2);
  for (const int number : {1, 2, 3}) {
    const auto moved = graph.process(pairWithArm(number));
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->image.data, first->image.data) << number;
  }
}

TEST(Masks, OfFiles) {
  const std::string path = std::filesystem::temp_directory_path() / "fdp_stereo_masks_test.png";
  writeImage(path, maskImage());
  NodeletGraph graph("/files", {{"left_mask", path}, {"right_mask", path}});
  expectThatAnArmChangesNothing(graph);
  std::filesystem::remove(path);
}

TEST(Masks, OfTopics) {
  NodeletGraph graph("/topics");
  ros::Publisher left = graph.node().advertise<sensor_msgs::Image>("left/mask", 1, true);
  ros::Publisher right = graph.node().advertise<sensor_msgs::Image>("right/mask", 1, true);
  left.publish(imageMessage(maskImage(), "mono8"));
  right.publish(imageMessage(maskImage(), "mono8"));
  EXPECT_TRUE(test::waitUntil([&] {
    const auto disparity = graph.process(pairWithArm(0));
    return disparity && !knownUnderTheMask(*disparity);
  }));
  ros::WallDuration(0.3).sleep();  // for the other of the two
  expectThatAnArmChangesNothing(graph);
}

TEST(Masks, OfAnotherSizeOrEncodingAreSaidAndRecoveredFrom) {
  struct Bad {
    sensor_msgs::Image mask;
    std::vector<std::string> said;
  };
  const Bad table[] = {
      {imageMessage(cv::Mat(60, 160, CV_8UC1, cv::Scalar(0)), "mono8"), {"/bad/left/mask", "160 x 60", "160 x 120"}},
      {imageMessage(cv::Mat(120, 160, CV_32FC1, cv::Scalar(0)), "32FC1"), {"/bad/left/mask", "'32FC1'"}},
      {sensor_msgs::Image(), {"/bad/left/mask", "encoding ''"}},
  };
  NodeletGraph graph("/bad");
  ros::Publisher publisher = graph.node().advertise<sensor_msgs::Image>("left/mask", 1, true);
  for (const Bad& bad : table) {
    LogLines log;
    ASSERT_TRUE(graph.process(test::goodMessages()));
    publisher.publish(bad.mask);
    EXPECT_TRUE(test::waitUntil([&] {
      graph.process(test::goodMessages(), 0.3);
      return !log.wait(bad.said, 0.1).empty();
    })) << bad.said[1];
    publisher.publish(imageMessage(maskImage(), "mono8"));
    EXPECT_TRUE(graph.process(test::goodMessages())) << "recovers";
  }
}

TEST(Masks, AFileThatIsMissingIsSaid) {
  LogLines log;
  NodeletGraph graph("/missing", {{"right_mask", "/nowhere/mask.png"}});
  EXPECT_FALSE(graph.process(test::goodMessages(), 1.0)) << "an arm that is taken for the scene would be worse";
  EXPECT_NE(log.wait({"~right_mask", "/nowhere/mask.png"}), "");
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "masks_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
