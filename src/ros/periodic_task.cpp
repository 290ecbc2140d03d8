// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "periodic_task.hpp"

#include <cstdio>
#include <exception>
#include <utility>

namespace fdp_stereo {

PeriodicTask::PeriodicTask(std::chrono::duration<double> period, std::function<void()> task)
    : thread_([this, period, task = std::move(task)] {
        std::unique_lock<std::mutex> lock(mutex_);
        while (!ended_.wait_for(lock, period, [this] { return end_; })) {
          lock.unlock();
          try {
            task();
          } catch (const std::exception& error) {  // of this round only: the next one may have the memory again
            std::fprintf(stderr, "fdp_stereo: a report was lost: %s\n", error.what());
          }
          lock.lock();
        }
      }) {}

PeriodicTask::~PeriodicTask() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

}  // namespace fdp_stereo
