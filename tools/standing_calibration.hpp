// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <boost/make_shared.hpp>

#include "bag_topics.hpp"
#include "calibration_file.hpp"

namespace fdp_stereo {

/// The calibration of one view where it does not come with every image: from a file, or sent once or now and then.
class StandingCalibration {
 public:
  StandingCalibration(const rosbag::Bag& bag, const BagTopics& counts, const std::string& image_topic,
                      const std::string& info_topic, const std::string& file) {
    if (!file.empty()) {
      info_ = boost::make_shared<sensor_msgs::CameraInfo>(readCalibration(file));
    } else if (counts.count(image_topic) > 1 && 2 * counts.count(info_topic) <= counts.count(image_topic)) {
      rosbag::View infos(bag, rosbag::TopicQuery(info_topic));
      info_ = infos.begin()->instantiate<sensor_msgs::CameraInfo>();
    }
  }
  bool inForce() const { return info_ != nullptr; }
  void replace(const sensor_msgs::CameraInfoConstPtr& info) { info_ = info; }
  /// The calibration as if it had come with an image.
  sensor_msgs::CameraInfoConstPtr at(const std_msgs::Header& header) const {
    auto info = boost::make_shared<sensor_msgs::CameraInfo>(*info_);
    info->header.stamp = header.stamp;
    if (info->header.frame_id.empty()) info->header.frame_id = header.frame_id;
    return info;
  }

 private:
  sensor_msgs::CameraInfoConstPtr info_;
};

}  // namespace fdp_stereo
