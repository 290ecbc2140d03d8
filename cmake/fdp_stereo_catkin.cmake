# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
find_package(catkin REQUIRED COMPONENTS
  cv_bridge diagnostic_updater dynamic_reconfigure image_transport message_filters nodelet rosbag roscpp sensor_msgs
  stereo_msgs tf2_ros)
generate_dynamic_reconfigure_options(cfg/Disparity.cfg)
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES fdp_stereo_core
  DEPENDS OpenCV EIGEN3)
