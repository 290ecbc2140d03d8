// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The nodelet fdp_stereo/disparity as a plain node.
#include <cstdio>
#include <cstdlib>

#include <nodelet/loader.h>
#include <ros/ros.h>
#include <opencv2/core/utility.hpp>

#include "fdp_stereo/out_of_memory.hpp"

int main(int argc, char** argv) {
  fdp_stereo::terminateWithMessage("disparity");
  cv::setNumThreads(1);  // its pool waits for ever for a thread that could not be started, as where memory is short
  ros::init(argc, argv, "disparity");
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), "fdp_stereo/disparity", ros::names::getRemappings(), {})) {
    std::fputs("disparity: the node cannot be started; where nothing else is said above, memory or threads ran out\n",
               stderr);
    return EXIT_FAILURE;
  }
  ros::spin();
  return 0;
}
