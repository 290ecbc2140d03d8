// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace fdp_stereo {

/// One thread that works on the newest frame. A frame that arrives meanwhile waits; the next one replaces it, so that
/// the latency is the processing time plus at most one frame whatever the input rate is.
template <typename Frame>
class NewestWorker {
 public:
  /// Runs in the worker's thread; should not throw, which loses the frame; should end soon once `cancel` is set.
  using Job = std::function<void(const Frame& frame, const std::atomic<bool>& cancel)>;

  explicit NewestWorker(Job job) : job_(std::move(job)), thread_([this] { loop(); }) {}
  ~NewestWorker() { stop(); }
  NewestWorker(const NewestWorker&) = delete;
  NewestWorker& operator=(const NewestWorker&) = delete;

  void submit(Frame frame) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (newest_) ++dropped_;
      newest_ = std::move(frame);
    }
    wake_.notify_one();
  }

  /// Cancels the running frame, forgets the waiting one and joins the thread; no frame is worked on afterwards.
  void stop() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
      newest_.reset();
    }
    cancel_ = true;
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

  /// Forgets the waiting frame without counting it.
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    newest_.reset();
  }

  /// Frames that were replaced before the worker came to them.
  std::uint64_t dropped() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return dropped_;
  }

  /// Frames that wait, 0 or 1.
  int waiting() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return newest_ ? 1 : 0;
  }

 private:
  void loop() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return stop_ || newest_; });
      if (stop_) return;
      const Frame frame = std::move(*newest_);
      newest_.reset();
      lock.unlock();
      try {
        job_(frame, cancel_);
      } catch (...) {  // not even the report of its failure could be made: the frame is lost, the thread is not
        std::fputs("fdp_stereo: a pair was lost, for lack of memory even its error message\n", stderr);
      }
      lock.lock();
    }
  }

  Job job_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Frame> newest_;
  std::uint64_t dropped_ = 0;
  bool stop_ = false;
  std::atomic<bool> cancel_{false};
  std::thread thread_;
};

}  // namespace fdp_stereo
