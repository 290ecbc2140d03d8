// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>

#include "params_ros.hpp"

namespace fdp_stereo {

/// Groups and their states as the cfg file has them.
std::vector<dynamic_reconfigure::GroupState> initialGroups();

/// The node's side of dynamic_reconfigure. dynamic_reconfigure::Server writes every parameter to the parameter server
/// at every edit, one call each, which takes some 100 ms with a list as long as ours; this one writes what changed.
class ReconfigureServer {
 public:
  /// Says what had to be corrected.
  using Report = std::function<void(const std::string& message)>;

  /// Loads `~preset`, the YAML text `~params` over it and the private parameters over both, and writes the result back.
  /// `others`: private parameters that belong to somebody else.
  ReconfigureServer(const ros::NodeHandle& private_node, const std::vector<std::string>& others, Report report);

  /// The newest set; it never changes once handed out.
  std::shared_ptr<const NodeSettings> settings() const;

  /// An edit that the node itself makes; what had to be corrected is reported.
  void apply(const dynamic_reconfigure::Config& edits);

 private:
  bool onSetParameters(dynamic_reconfigure::Reconfigure::Request& request,
                       dynamic_reconfigure::Reconfigure::Response& response);
  NodeSettings loadInitial(const std::vector<std::string>& others);
  /// Names, groups and flags as the tools of dynamic_reconfigure expect them.
  dynamic_reconfigure::Config completeConfig(const NodeSettings& settings) const;
  void adopt(const NodeSettings& settings);
  /// Writes the values that the parameter server does not have yet.
  void writeBack(const dynamic_reconfigure::Config& values);
  void publishDescription();

  ros::NodeHandle node_;
  Report report_;
  std::mutex edit_mutex_;  ///< held from reading the settings to storing their successor
  mutable std::mutex mutex_;
  std::shared_ptr<const NodeSettings> settings_;
  dynamic_reconfigure::Config written_;
  std::vector<dynamic_reconfigure::GroupState> groups_;  ///< whether rqt shows them open
  ros::Publisher description_;
  ros::Publisher updates_;
  ros::ServiceServer service_;
};

}  // namespace fdp_stereo
