# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# What find_package(fdp_stereo) gives: the target fdp_stereo::core. catkin's own package file includes this one.
include(CMakeFindDependencyMacro)
find_dependency(OpenCV COMPONENTS core imgproc imgcodecs features2d)
find_dependency(Eigen3)
if(NOT TARGET fdp_stereo::core)
  include(${fdp_stereo_DIR}/fdp_stereoTargets.cmake)
endif()
get_target_property(_fdp_stereo_type fdp_stereo::core TYPE)
if(_fdp_stereo_type STREQUAL STATIC_LIBRARY) # which leaves the libraries of its own to whoever links it
  find_dependency(OpenMP COMPONENTS CXX)
  find_dependency(yaml-cpp)
endif()
unset(_fdp_stereo_type)
