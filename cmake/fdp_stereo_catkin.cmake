# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
find_package(catkin REQUIRED COMPONENTS
  diagnostic_updater dynamic_reconfigure geometry_msgs image_geometry image_transport message_filters nodelet pluginlib rosbag roscpp sensor_msgs
  stereo_msgs tf2 tf2_ros)
generate_dynamic_reconfigure_options(cfg/Disparity.cfg cfg/Points.cfg)
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES fdp_stereo_core
  CATKIN_DEPENDS dynamic_reconfigure geometry_msgs nodelet roscpp sensor_msgs stereo_msgs
  DEPENDS EIGEN3 OpenCV
  CFG_EXTRAS fdp_stereo-extras.cmake)
