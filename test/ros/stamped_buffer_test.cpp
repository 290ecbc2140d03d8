// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stamped_buffer.hpp"

#include <thread>

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

namespace fdp_stereo {
namespace {

using Buffer = StampedBuffer<int>;
using Clock = Buffer::Clock;

constexpr double kMaxAge = 0.1;

void add(Buffer& buffer, int value, double seconds) {
  buffer.add(boost::make_shared<const int>(value), ros::Time(seconds));
}

/// The value, -1 for none.
int valueAt(Buffer& buffer, double seconds) {
  const auto found = buffer.nearest(ros::Time(seconds), kMaxAge, Clock::now(), nullptr);
  return found ? *found : -1;
}

TEST(StampedBuffer, TheNearestWithinItsAge) {
  Buffer buffer;
  EXPECT_FALSE(buffer.heard());
  EXPECT_EQ(valueAt(buffer, 10.0), -1);
  add(buffer, 1, 10.0);
  add(buffer, 2, 10.1);
  EXPECT_TRUE(buffer.heard());
  EXPECT_EQ(valueAt(buffer, 10.04), 1);
  EXPECT_EQ(valueAt(buffer, 10.06), 2);
  EXPECT_EQ(valueAt(buffer, 10.3), -1);
  add(buffer, 3, 5.0);
  EXPECT_EQ(valueAt(buffer, 10.0), -1) << "a bag that starts again";
  EXPECT_EQ(valueAt(buffer, 5.0), 3);
}

TEST(StampedBuffer, WaitsForAMessageOfTheTime) {
  Buffer buffer;
  add(buffer, 1, 9.95);
  std::thread sender([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    add(buffer, 2, 10.0);
  });
  const auto found = buffer.nearest(ros::Time(10.0), kMaxAge, Clock::now() + std::chrono::seconds(60), nullptr);
  sender.join();
  ASSERT_TRUE(found);
  EXPECT_EQ(*found, 2);
}

TEST(StampedBuffer, TheDeadlineEndsTheWaiting) {
  Buffer buffer;
  add(buffer, 1, 9.95);
  const auto start = Clock::now();
  const auto found = buffer.nearest(ros::Time(10.0), kMaxAge, start + std::chrono::milliseconds(50), nullptr);
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds(50));
  ASSERT_TRUE(found) << "what there is";
}

/// As when the nodelet is unloaded meanwhile.
TEST(StampedBuffer, ACancelledFrameDoesNotWait) {
  Buffer buffer;
  add(buffer, 1, 9.95);
  std::atomic<bool> cancel{false};
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    cancel = true;
  });
  const auto start = Clock::now();
  buffer.nearest(ros::Time(10.0), kMaxAge, start + std::chrono::seconds(60), &cancel);
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(30));
  stopper.join();
}

}  // namespace
}  // namespace fdp_stereo
