// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <mutex>
#include <string>

#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>
#include <opencv2/core.hpp>

#include "start_params.hpp"

namespace fdp_stereo {

/// What to leave out of the left and the right image.
using MaskPair = std::array<cv::Mat, 2>;

/// Masks from files (~left_mask, ~right_mask) or topics (left/mask, right/mask), whose newest message replaces the
/// file.
class MaskSources {
 public:
  MaskSources(const ros::NodeHandle& node, StartParams& params);

  void subscribe();
  void unsubscribe();

  /// A MaskProvider. size: px of the images. Throws std::invalid_argument where a mask that is wanted cannot be used:
  /// an arm that is taken for the scene is worse than no disparity.
  MaskPair masks(cv::Size size);

 private:
  struct Source {
    std::string name;  ///< of the parameter
    std::string path;
    std::string topic;
    cv::Mat mask;
    sensor_msgs::ImageConstPtr message;  ///< not used yet
    ros::Subscriber subscriber;
  };
  static cv::Mat maskOf(Source& source, cv::Size size);

  ros::NodeHandle node_;
  std::mutex mutex_;
  std::array<Source, 2> sources_;
};

}  // namespace fdp_stereo
