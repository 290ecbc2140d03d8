// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_topics.hpp"

#include <sstream>

#include <rosbag/view.h>

namespace fdp_stereo {

std::string normalName(const std::string& name) {
  std::string normal;
  std::istringstream parts(name);
  for (std::string part; std::getline(parts, part, '/');) {
    if (!part.empty()) normal += "/" + part;
  }
  return normal;
}

BagTopics::BagTopics(const rosbag::Bag& bag) {
  rosbag::View all(bag);
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    rosbag::View own(bag, rosbag::TopicQuery(connection->topic));
    topics_[normalName(connection->topic)] = {connection->topic, connection->datatype, own.size()};
  }
}

std::string BagTopics::find(const std::string& topic, const std::string& type) const {
  const auto found = topics_.find(normalName(topic));
  return found != topics_.end() && found->second.type == type ? found->second.spelling : "";
}

std::size_t BagTopics::count(const std::string& topic) const {
  const auto found = topics_.find(normalName(topic));
  return found == topics_.end() ? 0 : found->second.count;
}

std::string BagTopics::list() const {
  constexpr int kMost = 20;
  std::string text;
  int named = 0;
  for (const auto& [name, topic] : topics_) {
    if (named++ < kMost) text += " " + name + " (" + topic.type + ")";
  }
  return text + (named > kMost ? " and " + std::to_string(named - kMost) + " more" : "");
}

}  // namespace fdp_stereo
