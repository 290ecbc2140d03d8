// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

namespace fdp_stereo {

/// A synchronised pair as it arrived. The messages may be shared with other nodelets: never written.
struct StereoFrame {
  sensor_msgs::ImageConstPtr left;
  sensor_msgs::ImageConstPtr right;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::CameraInfoConstPtr right_info;
  std::chrono::steady_clock::time_point arrival;
};

/// One thread that works on the newest frame. A frame that arrives meanwhile waits; the next one replaces it, so that
/// the latency is the processing time plus at most one frame whatever the input rate is.
class FrameWorker {
 public:
  /// Runs in the worker's thread; should not throw, which loses the frame; should end soon once `cancel` is set.
  using Job = std::function<void(const StereoFrame& frame, const std::atomic<bool>& cancel)>;

  explicit FrameWorker(Job job);
  ~FrameWorker();
  FrameWorker(const FrameWorker&) = delete;
  FrameWorker& operator=(const FrameWorker&) = delete;

  void submit(StereoFrame frame);
  /// Cancels the running frame, forgets the waiting one and joins the thread; no frame is worked on afterwards.
  void stop();
  /// Forgets the waiting frame without counting it.
  void clear();
  /// Frames that were replaced before the worker came to them.
  std::uint64_t dropped() const;
  /// Frames that wait, 0 or 1.
  int waiting() const;

 private:
  void loop();

  Job job_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<StereoFrame> newest_;
  std::uint64_t dropped_ = 0;
  bool stop_ = false;
  std::atomic<bool> cancel_{false};
  std::thread thread_;
};

}  // namespace fdp_stereo
