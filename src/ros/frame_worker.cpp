// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_worker.hpp"

#include <cstdio>
#include <utility>

namespace fdp_stereo {

FrameWorker::FrameWorker(Job job) : job_(std::move(job)), thread_([this] { loop(); }) {}

FrameWorker::~FrameWorker() { stop(); }

void FrameWorker::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
    newest_.reset();
  }
  cancel_ = true;
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void FrameWorker::submit(StereoFrame frame) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (newest_) ++dropped_;
    newest_ = std::move(frame);
  }
  wake_.notify_one();
}

void FrameWorker::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  newest_.reset();
}

std::uint64_t FrameWorker::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

int FrameWorker::waiting() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_ ? 1 : 0;
}

void FrameWorker::loop() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || newest_; });
    if (stop_) return;
    const StereoFrame frame = std::move(*newest_);
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

}  // namespace fdp_stereo
