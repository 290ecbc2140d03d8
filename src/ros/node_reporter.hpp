// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include "node_status.hpp"
#include "periodic_task.hpp"

namespace fdp_stereo {

/// Keeps the node's status, and tells it: in the log, in /diagnostics, and where nothing comes out. Thread-safe.
class NodeReporter {
 public:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  struct Periods {
    Seconds diagnostics;
    Seconds watch;  ///< over the ROS master, and over silence
  };

  /// name: of the node, in the log and in /diagnostics.
  void setName(const std::string& name) { name_ = name; }
  /// Begins to report. `complete` adds to a copy of the status what others know; it is called from threads of its own.
  void start(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const Periods& periods,
             std::function<void(NodeStatus&)> complete);
  void stop();

  /// change(NodeStatus&) with the status locked.
  template <typename Change>
  void update(const Change& change) {
    const std::lock_guard<std::mutex> lock(mutex_);
    change(status_);
  }
  /// What keeps coming is said once.
  void warn(const std::string& text);
  void recordSuccess(const StereoFrame& frame, FrameReport report, Clock::time_point start, unsigned revision);
  void recordFailure(const std::string& problem);

 private:
  bool isNew(const std::string& text);
  NodeStatus snapshot();
  void describe(diagnostic_updater::DiagnosticStatusWrapper& diagnostics);
  void watch();
  void askMaster();

  std::string name_;
  std::function<void(NodeStatus&)> complete_;
  std::mutex mutex_;
  NodeStatus status_;
  NodeStatus diagnosed_, watched_;  ///< at the last report
  Clock::time_point diagnosed_at_, watched_at_;
  LogThrottle throttle_{std::chrono::seconds(30), 20};
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  std::unique_ptr<PeriodicTask> diagnostics_task_, watch_task_;
};

}  // namespace fdp_stereo
