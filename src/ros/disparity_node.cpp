// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The nodelet fdp_stereo/disparity as a plain node.
#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "disparity");
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), "fdp_stereo/disparity", ros::names::getRemappings(), {})) return 1;
  ros::spin();
  return 0;
}
