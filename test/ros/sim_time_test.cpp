// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The clock of a simulation or of a played bag: it may not run yet, jump ahead, and jump back.
#include <dynamic_reconfigure/config_tools.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Clock.h>

#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using test::goodMessages;
using test::Messages;
using test::NodeletGraph;
using test::waitUntil;

class SimTime : public ::testing::Test {
 protected:
  SimTime() { clock_ = ros::NodeHandle().advertise<rosgraph_msgs::Clock>("/clock", 1); }

  bool setClock(double seconds) {
    rosgraph_msgs::Clock message;
    message.clock = ros::Time(seconds);
    return waitUntil([&] {
      clock_.publish(message);
      return ros::Time::now() == message.clock;
    });
  }

  /// A camera at 20 Hz of its own time, from `seconds` on, until a disparity of that time comes.
  bool comesOut(NodeletGraph& graph, double seconds) {
    const ros::Time first(seconds);
    Messages messages = goodMessages();
    int sent = 0;
    return waitUntil([&] {
      messages.stamp(first + ros::Duration(0.05 * (sent++ % 100)));
      graph.camera().publish(messages);
      const auto fits = [&](const auto& d) {
        return d.header.stamp >= first && d.header.stamp < first + ros::Duration(10.0);
      };
      return graph.disparity().wait(fits, 0.3) != nullptr;
    });
  }

  ros::Publisher clock_;
};

TEST_F(SimTime, NoClockAJumpAheadAndAJumpBack) {
  NodeletGraph graph("/sim", {{"max_age", 100.0}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  EXPECT_TRUE(comesOut(graph, 500.0)) << "before the clock runs";
  ASSERT_TRUE(setClock(500.0));
  EXPECT_TRUE(comesOut(graph, 510.0));
  ASSERT_TRUE(setClock(5000.0));
  EXPECT_TRUE(comesOut(graph, 5000.0)) << "a jump ahead";
  graph.disparity().clear();
  Messages old = goodMessages();
  old.stamp(ros::Time(4800.0));
  for (int i = 0; i < 5; ++i) graph.camera().publish(old);
  EXPECT_TRUE(comesOut(graph, 5020.0));
  EXPECT_FALSE(graph.disparity().wait([](const auto& d) { return d.header.stamp == ros::Time(4800.0); }, 0.0))
      << "older than max_age";
  ASSERT_TRUE(setClock(100.0));
  EXPECT_TRUE(comesOut(graph, 100.0)) << "a jump back";
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sim_time_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
