// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

namespace fdp_stereo {

/// What one cloud is made of, all of one stamp. The messages may be shared with other nodelets: never written.
struct PointFrame {
  stereo_msgs::DisparityImageConstPtr disparity;
  sensor_msgs::CameraInfoConstPtr info;
  sensor_msgs::ImageConstPtr image;        ///< null where no cloud is wanted
  sensor_msgs::ImageConstPtr confidence;   ///< may be null
  sensor_msgs::ImageConstPtr depth_error;  ///< may be null
};

/// Makes frames of messages with equal stamps. Disparity and camera_info are always needed. No node needed; one thread
/// at a time.
class PointFrameCollector {
 public:
  struct Needs {
    bool image = true;
    /// A frame waits for these only until the next one has all the others.
    bool confidence = false;
    bool depth_error = false;
  };

  /// queue_size: frames that wait for their parts.
  explicit PointFrameCollector(std::size_t queue_size) : queue_size_(queue_size) {}

  /// part: a member of PointFrame. Gives the frame that this completes.
  template <typename Part>
  std::optional<PointFrame> add(Part PointFrame::*part, std::size_t topic, const Part& message, const ros::Time& stamp,
                                const Needs& needs) {
    if (stamp < newest_[topic]) clear();  // a bag that starts again
    newest_[topic] = stamp;
    frames_[stamp].*part = message;
    std::optional<PointFrame> ready = take(needs);
    while (frames_.size() > queue_size_) frames_.erase(frames_.begin());
    return ready;
  }
  void clear();

 private:
  static bool hasNeeded(const PointFrame& frame, const Needs& needs);
  static bool isComplete(const PointFrame& frame, const Needs& needs);
  std::optional<PointFrame> take(const Needs& needs);

  std::size_t queue_size_;
  std::array<ros::Time, 5> newest_;  ///< per topic
  std::map<ros::Time, PointFrame> frames_;
};

}  // namespace fdp_stereo
