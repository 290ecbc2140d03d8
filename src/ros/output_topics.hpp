// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>

#include "frame_processor.hpp"

namespace fdp_stereo {

/// What the node publishes.
class OutputTopics {
 public:
  /// The rectified left image is an output where raw images come in. `changed` is called whenever a subscriber comes or
  /// goes, perhaps before this returns.
  void advertise(ros::NodeHandle& node, InputImages images, const std::function<void()>& changed);
  void shutdown();
  /// What has subscribers.
  WantedOutputs wanted() const;
  void publish(const FrameOutput& output) const;

 private:
  ros::Publisher disparity_;
  image_transport::CameraPublisher depth_;
  image_transport::Publisher depth_by_old_name_, confidence_, depth_error_, seeds_, disparity_color_;
  image_transport::Publisher left_rectified_;  ///< nothing where the images are rectified by others
};

}  // namespace fdp_stereo
