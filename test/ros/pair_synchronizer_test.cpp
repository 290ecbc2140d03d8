// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair_synchronizer.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

namespace fdp_stereo {
namespace {

constexpr PairSynchronizer::Input kInputs[] = {PairSynchronizer::kLeftImage, PairSynchronizer::kLeftInfo,
                                               PairSynchronizer::kRightImage, PairSynchronizer::kRightInfo};

/// A synchroniser without a node, a clock or a roscore.
class Pairs {
 public:
  explicit Pairs(const PairSynchronizerParams& params = {})
      : synchronizer_(params, {[this](const StereoFrame& frame) { frames.push_back(frame); }, [this] { ++restarts; },
                               [this](PairSynchronizer::Input input, const ros::Time&) { hostile.push_back(input); }}) {
  }

  void add(PairSynchronizer::Input input, const ros::Time& stamp) {
    if (input == PairSynchronizer::kLeftImage || input == PairSynchronizer::kRightImage) {
      const auto image = boost::make_shared<sensor_msgs::Image>();
      image->header.stamp = stamp;
      synchronizer_.add(input, image);
    } else {
      const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
      info->header.stamp = stamp;
      synchronizer_.add(input, info);
    }
  }
  /// All four topics, the right ones `apart_s` later.
  void addAll(double seconds, double apart_s = 0.0) {
    for (const auto input : kInputs) {
      const bool right = input == PairSynchronizer::kRightImage || input == PairSynchronizer::kRightInfo;
      add(input, ros::Time(seconds + (right ? apart_s : 0.0)));
    }
  }
  PairSynchronizer::Counts counts() const { return synchronizer_.counts(); }

  std::vector<StereoFrame> frames;
  int restarts = 0;
  std::vector<PairSynchronizer::Input> hostile;

 private:
  PairSynchronizer synchronizer_;
};

TEST(PairSynchronizer, EqualStampsMakeAPairInAnyOrder) {
  Pairs pairs;
  pairs.add(PairSynchronizer::kRightInfo, ros::Time(1.3));
  pairs.addAll(1.0);
  ASSERT_EQ(pairs.frames.size(), 1U);
  const StereoFrame& frame = pairs.frames[0];
  for (const auto& header :
       {frame.left->header, frame.right->header, frame.left_info->header, frame.right_info->header}) {
    EXPECT_EQ(header.stamp, ros::Time(1.0));
  }
  pairs.add(PairSynchronizer::kLeftImage, ros::Time(1.3));
  pairs.add(PairSynchronizer::kRightImage, ros::Time(1.3));
  EXPECT_EQ(pairs.frames.size(), 1U);
  pairs.add(PairSynchronizer::kLeftInfo, ros::Time(1.3));
  EXPECT_EQ(pairs.frames.size(), 2U);
}

TEST(PairSynchronizer, CountsPerTopic) {
  Pairs pairs;
  pairs.addAll(1.0);
  pairs.add(PairSynchronizer::kRightImage, ros::Time(1.5));
  EXPECT_EQ(pairs.counts()[PairSynchronizer::kLeftInfo].received, 1U);
  EXPECT_EQ(pairs.counts()[PairSynchronizer::kRightImage].received, 2U);
  EXPECT_EQ(pairs.counts()[PairSynchronizer::kRightImage].stamp, ros::Time(1.5));
}

TEST(PairSynchronizer, NearStampsOnlyWhereThatIsWanted) {
  Pairs exact;
  Pairs approximate({5, true, 0.0});
  for (int i = 0; i < 5; ++i) {
    exact.addAll(1.0 + 0.1 * i, 1e-6);
    approximate.addAll(1.0 + 0.1 * i, 0.004);
  }
  EXPECT_TRUE(exact.frames.empty());
  ASSERT_GE(approximate.frames.size(), 3U);
  for (const StereoFrame& frame : approximate.frames) {
    EXPECT_NEAR((frame.right->header.stamp - frame.left->header.stamp).toSec(), 0.004, 1e-6);
  }
}

TEST(PairSynchronizer, TheToleranceIsKept) {
  Pairs near({5, true, 0.005});
  Pairs far({5, true, 0.003});
  for (int i = 0; i < 5; ++i) {
    near.addAll(1.0 + 0.1 * i, 0.004);
    far.addAll(1.0 + 0.1 * i, 0.004);
  }
  EXPECT_GE(near.frames.size(), 3U);
  EXPECT_TRUE(far.frames.empty());
}

/// Messages that lack a partner wait, but no more than queue_size of them.
TEST(PairSynchronizer, TheQueueIsBounded) {
  for (const int queue_size : {1, 3}) {
    Pairs pairs({queue_size, false, 0.0});
    for (int i = 0; i < 10; ++i) pairs.add(PairSynchronizer::kLeftImage, ros::Time(1.0 + 0.1 * i));
    for (const auto input : {kInputs[1], kInputs[2], kInputs[3]}) pairs.add(input, ros::Time(1.0));
    EXPECT_TRUE(pairs.frames.empty()) << "long gone";
  }
}

/// A bag that loops: what waited of the last round must not keep the new one out.
TEST(PairSynchronizer, StampsThatJumpBackStartAnew) {
  for (const bool approximate : {false, true}) {
    Pairs pairs({5, approximate, 0.0});
    pairs.addAll(100.0);
    for (int i = 0; i < 20; ++i) pairs.add(PairSynchronizer::kLeftImage, ros::Time(100.1 + 0.1 * i));
    pairs.frames.clear();
    for (int i = 0; i < 5; ++i) pairs.addAll(10.0 + 0.1 * i);
    EXPECT_EQ(pairs.restarts, 1) << "once, not once per topic";
    EXPECT_GE(pairs.frames.size(), 3U);
    EXPECT_EQ(pairs.counts()[PairSynchronizer::kLeftImage].stamp, ros::Time(10.4));
  }
}

TEST(PairSynchronizer, ALateMessageIsNoJump) {
  Pairs pairs;
  pairs.addAll(1.0);
  pairs.add(PairSynchronizer::kLeftImage, ros::Time(1.3));
  pairs.addAll(1.2);
  EXPECT_EQ(pairs.restarts, 0);
  EXPECT_EQ(pairs.frames.size(), 2U);
}

TEST(PairSynchronizer, StampsOfAnyValue) {
  for (const bool approximate : {false, true}) {
    Pairs pairs({5, approximate, 0.0});
    const ros::Time stamps[] = {ros::Time(0, 0), ros::Time(0xFFFFFFFFU, 999999999U), ros::Time(0x80000000U, 1),
                                ros::Time(5, 0)};
    for (const ros::Time& stamp : stamps) {
      for (const auto input : kInputs) pairs.add(input, stamp);
      pairs.add(PairSynchronizer::kLeftImage, stamps[1]);
    }
    pairs.frames.clear();
    for (int i = 0; i < 5; ++i) pairs.addAll(50.0 + 0.1 * i);
    EXPECT_GE(pairs.frames.size(), 3U) << approximate;
  }
}

}  // namespace
}  // namespace fdp_stereo
