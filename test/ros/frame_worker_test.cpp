// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_worker.hpp"

#include <future>
#include <vector>

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

namespace fdp_stereo {
namespace {

constexpr auto kPatience = std::chrono::seconds(20);

StereoFrame frameNumber(std::uint32_t number) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.seq = number;
  StereoFrame frame;
  frame.left = image;
  return frame;
}

/// A job that says when it starts and ends when it is told.
class Gate {
 public:
  FrameWorker::Job job() {
    return [this](const StereoFrame& frame, const std::atomic<bool>&) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        seen_.push_back(frame.left->header.seq);
      }
      changed_.notify_all();
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait_for(lock, kPatience, [this] { return open_; });
    };
  }
  bool waitForSeen(std::size_t count) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return seen_.size() >= count; });
  }
  void open() {
    const std::lock_guard<std::mutex> lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  std::vector<std::uint32_t> seen() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return seen_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  std::vector<std::uint32_t> seen_;
};

TEST(FrameWorker, TakesTheNewestAndCountsTheRest) {
  Gate gate;
  FrameWorker worker(gate.job());
  worker.submit(frameNumber(0));
  ASSERT_TRUE(gate.waitForSeen(1));
  for (std::uint32_t i = 1; i <= 10; ++i) worker.submit(frameNumber(i));
  EXPECT_EQ(worker.waiting(), 1);
  EXPECT_EQ(worker.dropped(), 9U);
  gate.open();
  ASSERT_TRUE(gate.waitForSeen(2));
  EXPECT_EQ(gate.seen(), (std::vector<std::uint32_t>{0, 10}));
  EXPECT_EQ(worker.dropped(), 9U);
}

TEST(FrameWorker, ClearForgetsTheWaitingFrame) {
  Gate gate;
  FrameWorker worker(gate.job());
  worker.submit(frameNumber(0));
  ASSERT_TRUE(gate.waitForSeen(1));
  worker.submit(frameNumber(1));
  worker.clear();
  EXPECT_EQ(worker.waiting(), 0);
  gate.open();
  worker.submit(frameNumber(2));
  ASSERT_TRUE(gate.waitForSeen(2));
  EXPECT_EQ(gate.seen(), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(worker.dropped(), 0U);
}

TEST(FrameWorker, EndsWhileAFrameRuns) {
  std::promise<void> started;
  std::atomic<int> frames{0};
  auto worker = std::make_unique<FrameWorker>([&](const StereoFrame&, const std::atomic<bool>& cancel) {
    ++frames;
    started.set_value();
    while (!cancel) std::this_thread::yield();
  });
  worker->submit(frameNumber(0));
  ASSERT_EQ(started.get_future().wait_for(kPatience), std::future_status::ready);
  worker->submit(frameNumber(1));
  worker.reset();  // hangs here if the frame is not cancelled
  EXPECT_EQ(frames, 1) << "the waiting frame is forgotten";
}

TEST(FrameWorker, WorksOnNothingAfterItsStop) {
  std::atomic<int> jobs{0};
  FrameWorker worker([&](const StereoFrame&, const std::atomic<bool>&) { ++jobs; });
  worker.stop();
  worker.submit(frameNumber(1));
  worker.stop();
  EXPECT_EQ(jobs, 0);
}

TEST(FrameWorker, EndsIdle) {
  for (int i = 0; i < 100; ++i) FrameWorker worker([](const StereoFrame&, const std::atomic<bool>&) {});
}

}  // namespace
}  // namespace fdp_stereo
