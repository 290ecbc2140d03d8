// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

namespace fdp_stereo {

/// Private parameters that are read once, at the start. Remembers their names, so that whoever judges the others knows
/// them.
class StartParams {
 public:
  explicit StartParams(ros::NodeHandle private_node) : node_(std::move(private_node)) {}

  template <typename Value>
  Value param(const std::string& name, const Value& fallback) {
    names_.push_back(name);
    return node_.param(name, fallback);
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  ros::NodeHandle node_;
  std::vector<std::string> names_;
};

}  // namespace fdp_stereo
