// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "periodic_task.hpp"

#include <atomic>
#include <future>

#include <gtest/gtest.h>

namespace fdp_stereo {
namespace {

using namespace std::chrono_literals;

TEST(PeriodicTask, CallsAgainAndAgain) {
  std::atomic<int> calls{0};
  std::promise<void> three;
  const PeriodicTask task(1ms, [&] {
    if (++calls == 3) three.set_value();
  });
  EXPECT_EQ(three.get_future().wait_for(60s), std::future_status::ready);
}

TEST(PeriodicTask, ACallThatThrowsIsNotTheLast) {
  std::promise<void> again;
  std::atomic<int> calls{0};
  const PeriodicTask task(1ms, [&] {
    if (++calls == 1) throw std::bad_alloc();
    if (calls == 2) again.set_value();
  });
  EXPECT_EQ(again.get_future().wait_for(60s), std::future_status::ready);
}

TEST(PeriodicTask, EndsWithoutWaitingForThePeriod) {
  std::atomic<int> calls{0};
  {
    const PeriodicTask task(1h, [&] { ++calls; });
  }
  EXPECT_EQ(calls, 0);
}

TEST(PeriodicTask, ItsEndWaitsForTheCallThatRuns) {
  std::promise<void> running;
  std::atomic<bool> once{false};
  std::atomic<bool> finished{false};
  {
    const PeriodicTask task(1ms, [&] {
      if (once.exchange(true)) return;
      running.set_value();
      std::this_thread::sleep_for(30ms);
      finished = true;
    });
    running.get_future().wait();
  }
  EXPECT_TRUE(finished);
}

}  // namespace
}  // namespace fdp_stereo
