// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Looks at a running stereo camera for a while and says what is missing or off, and what to type.
// Run in the camera's namespace: ROS_NAMESPACE=stereo rosrun fdp_stereo doctor. Private parameters: seconds (10), node
// (the disparity node, "disparity"). Exit code 0 only if nothing is wrong.
#include <algorithm>
#include <cstdio>

#include <ros/ros.h>
#include <stereo_msgs/DisparityImage.h>

#include "diagnosis.hpp"

namespace {

using fdp_stereo::Observation;
using fdp_stereo::Verdict;

class Doctor {
 public:
  Doctor() {
    left_ = node_.subscribe("left/image_rect", 20, &Doctor::onLeft, this);
    right_ = node_.subscribe("right/image_rect", 20, &Doctor::onRight, this);
    left_info_ = node_.subscribe("left/camera_info", 20, &Doctor::onLeftInfo, this);
    right_info_ = node_.subscribe("right/camera_info", 20, &Doctor::onRightInfo, this);
    disparity_ = node_.subscribe("disparity", 20, &Doctor::onDisparity, this);
    const ros::Subscriber* inputs[] = {&left_, &left_info_, &right_, &right_info_};
    for (std::size_t i = 0; i < seen_.inputs.size(); ++i) seen_.inputs[i].topic = inputs[i]->getTopic();
  }

  Observation look(double seconds, const std::string& node) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
    while (ros::ok() && ros::WallTime::now() < end) {
      ros::spinOnce();
      ros::WallDuration(0.005).sleep();
    }
    const ros::Subscriber* inputs[] = {&left_, &left_info_, &right_, &right_info_};
    for (std::size_t i = 0; i < seen_.inputs.size(); ++i) seen_.inputs[i].publishers = inputs[i]->getNumPublishers();
    seen_.disparity_publishers = disparity_.getNumPublishers();
    seen_.seconds = seconds;
    seen_.node = node_.resolveName(node);
    ros::param::get(seen_.node + "/min_disparity", seen_.range.min);
    ros::param::get(seen_.node + "/disparity_range", seen_.range.count);
    ros::param::get(seen_.node + "/approximate_sync", seen_.approximate_sync);
    ros::param::get(seen_.node + "/approximate_sync_tolerance", seen_.tolerance_s);
    if (newest_.left && newest_.right && newest_.left_info && newest_.right_info) seen_.pair = newest_;
    return seen_;
  }

 private:
  void onLeft(const sensor_msgs::ImageConstPtr& message) {
    seen_.inputs[0].stamps.push_back(message->header.stamp);
    // A right image of the same time is better than the newest.
    if (!newest_.right || !newest_.left || newest_.left->header.stamp != newest_.right->header.stamp) {
      newest_.left = message;
    }
  }
  void onLeftInfo(const sensor_msgs::CameraInfoConstPtr& message) {
    seen_.inputs[1].stamps.push_back(message->header.stamp);
    newest_.left_info = message;
  }
  void onRight(const sensor_msgs::ImageConstPtr& message) {
    seen_.inputs[2].stamps.push_back(message->header.stamp);
    if (!newest_.right || !newest_.left || newest_.left->header.stamp != newest_.right->header.stamp) {
      newest_.right = message;
    }
  }
  void onRightInfo(const sensor_msgs::CameraInfoConstPtr& message) {
    seen_.inputs[3].stamps.push_back(message->header.stamp);
    newest_.right_info = message;
  }
  void onDisparity(const stereo_msgs::DisparityImageConstPtr&) { ++seen_.disparities; }

  ros::NodeHandle node_;
  ros::Subscriber left_, right_, left_info_, right_info_, disparity_;
  fdp_stereo::StereoFrame newest_;
  Observation seen_;
};

constexpr char kHelp[] =
    "Looks at a running stereo camera and says what is missing or off, and what to type.\n"
    "  ROS_NAMESPACE=stereo rosrun fdp_stereo doctor [_seconds:=10] [_node:=disparity]\n"
    "or roslaunch fdp_stereo doctor.launch. Exit code 0 only if nothing is wrong.\n";

const char* word(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good ";
    case Verdict::kOdd:
      return "odd  ";
    default:
      return "WRONG";
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string argument = argc == 2 ? argv[1] : "";
  if (argument == "--version" || argument == "--help") {
    std::printf("doctor %s\n%s", FDP_STEREO_VERSION, argument == "--help" ? kHelp : "");
    return 0;
  }
  ros::init(argc, argv, "doctor", ros::init_options::AnonymousName);
  ros::NodeHandle private_node("~");
  const double seconds = std::max(0.1, private_node.param("seconds", 10.0));
  Doctor doctor;
  std::printf("looking for %.0f s ...\n", seconds);
  std::fflush(stdout);
  bool wrong = false;
  for (const auto& finding :
       fdp_stereo::diagnose(doctor.look(seconds, private_node.param<std::string>("node", "disparity")))) {
    std::printf("%s  %s\n", word(finding.verdict), finding.text.c_str());
    if (!finding.remedy.empty()) std::printf("       -> %s\n", finding.remedy.c_str());
    wrong = wrong || finding.verdict == Verdict::kWrong;
  }
  return wrong ? 1 : 0;
}
