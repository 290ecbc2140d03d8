// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace fdp_stereo {

/// Calls a task once per period in a thread of its own, until it is destroyed. Unlike roscpp's timers it needs no queue
/// that images wait in, keeps going while a callback runs, and its end waits for the call that runs.
class PeriodicTask {
 public:
  /// The task must not throw. The first call comes after one period.
  PeriodicTask(std::chrono::duration<double> period, std::function<void()> task);
  ~PeriodicTask();
  PeriodicTask(const PeriodicTask&) = delete;
  PeriodicTask& operator=(const PeriodicTask&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace fdp_stereo
