// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "newest_worker.hpp"

namespace fdp_stereo {

/// A synchronised pair as it arrived. The messages may be shared with other nodelets: never written.
struct StereoFrame {
  sensor_msgs::ImageConstPtr left;
  sensor_msgs::ImageConstPtr right;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::CameraInfoConstPtr right_info;
  std::chrono::steady_clock::time_point arrival;
};

using FrameWorker = NewestWorker<StereoFrame>;

}  // namespace fdp_stereo
