// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "node_reporter.hpp"

#include <utility>

#include <ros/console.h>
#include <ros/master.h>

#include "stamps.hpp"

namespace fdp_stereo {
namespace {

double milliseconds(NodeReporter::Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

void NodeReporter::start(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const Periods& periods,
                         std::function<void(NodeStatus&)> complete) {
  complete_ = std::move(complete);
  diagnosed_at_ = watched_at_ = Clock::now();
  updater_ = std::make_unique<diagnostic_updater::Updater>(node, private_node, name_);
  updater_->setHardwareID("none");
  updater_->add("Disparity", this, &NodeReporter::describe);
  diagnostics_task_ = std::make_unique<PeriodicTask>(periods.diagnostics, [this] { updater_->force_update(); });
  // The question to a master that is out of reach may take long: not in the queue of the images.
  watch_task_ = std::make_unique<PeriodicTask>(periods.watch, [this] { watch(); });
}

void NodeReporter::stop() {
  diagnostics_task_.reset();
  updater_.reset();
  watch_task_.reset();
}

void NodeReporter::warn(const std::string& text) {
  if (isNew(text)) ROS_WARN_NAMED(name_, "%s", text.c_str());
}

void NodeReporter::recordSuccess(const StereoFrame& frame, FrameReport report, Clock::time_point start,
                                 unsigned revision) {
  const auto now = Clock::now();
  for (const std::string& warning : report.warnings) warn(warning);
  for (const std::string& note : report.notes) {
    if (isNew(note)) ROS_INFO_NAMED(name_, "%s", note.c_str());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.processed;
  status_.error_is_current = false;
  status_.processing_ms = milliseconds(now - start);
  status_.latency_ms = milliseconds(now - frame.arrival);
  status_.age_ms = secondsBetween(frame.left->header.stamp, ros::Time::now()) * 1e3;
  status_.apart_ms = secondsBetween(frame.left->header.stamp, frame.right->header.stamp) * 1e3;
  status_.revision = revision;
  const std::string& reset = report.pipeline.temporal.reset;
  if (!reset.empty()) {
    ++status_.temporal_resets;
    status_.last_temporal_reset = reset;
  }
  status_.frame = std::move(report);
}

void NodeReporter::recordFailure(const std::string& problem) {
  warn(problem);
  const std::lock_guard<std::mutex> lock(mutex_);
  ++status_.failed;
  status_.last_error = problem;
  status_.error_is_current = true;
}

bool NodeReporter::isNew(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return throttle_.allow(text, Clock::now());
}

NodeStatus NodeReporter::snapshot() {
  NodeStatus status;
  update([&](const NodeStatus& now) { status = now; });
  complete_(status);
  return status;
}

void NodeReporter::describe(diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  NodeStatus status = snapshot();
  const auto now = Clock::now();
  describeStatus(status, diagnosed_, milliseconds(now - diagnosed_at_) / 1e3, diagnostics);
  diagnosed_ = std::move(status);
  diagnosed_at_ = now;
}

void NodeReporter::askMaster() {
  const bool lost = !ros::master::check();
  bool changed = false;
  update([&](NodeStatus& status) {
    changed = lost != status.master_lost;
    status.master_lost = lost;
  });
  if (changed && lost) ROS_ERROR_NAMED(name_, "the ROS master does not answer; connected topics go on");
  if (changed && !lost) {
    ROS_WARN_NAMED(name_,
                   "the ROS master is back; if it was restarted it does not know this node: restart it (respawn)");
  }
}

void NodeReporter::watch() {
  askMaster();
  NodeStatus status = snapshot();
  const auto now = Clock::now();
  const std::string silence = describeSilence(status, watched_, milliseconds(now - watched_at_) / 1e3);
  if (!silence.empty()) ROS_WARN_NAMED(name_, "%s", silence.c_str());
  watched_ = std::move(status);
  watched_at_ = now;
}

}  // namespace fdp_stereo
