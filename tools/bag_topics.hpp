// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include <rosbag/bag.h>

namespace fdp_stereo {

/// A name of ROS with one slash before each part and none at the end; "" for the root, however it is spelt.
std::string normalName(const std::string& name);

/// The topics of a recording, by their normal names.
class BagTopics {
 public:
  explicit BagTopics(const rosbag::Bag& bag);

  /// The topic as the recording spells it; "" where it has none of this type ("sensor_msgs/Image").
  std::string find(const std::string& topic, const std::string& type) const;
  std::size_t count(const std::string& topic) const;
  /// Names and types, for messages to people.
  std::string list() const;

 private:
  struct Topic {
    std::string spelling;
    std::string type;
    std::size_t count = 0;
  };
  std::map<std::string, Topic> topics_;
};

}  // namespace fdp_stereo
