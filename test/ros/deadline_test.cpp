// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// deadline_ms: what the node gives up, what it says, and that it takes it back.
#include <gtest/gtest.h>

#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using diagnostic_msgs::DiagnosticArray;
using test::Inbox;
using test::NodeletGraph;

/// The node under pairs of a moving camera, whose pictures all differ.
class DeadlineTest : public ::testing::Test {
 protected:
  void process(int pairs) {
    for (int i = 0; i < pairs; ++i) {
      test::Messages messages = test::goodMessages(320, 240);
      const test::PlanePair pair = test::planePair(320, 240, test::kPlaneDisparity, static_cast<unsigned>(++number_));
      messages.left = test::imageMessage(pair.left, "mono8");
      messages.right = test::imageMessage(pair.right, "mono8");
      ASSERT_TRUE(graph_.process(messages));
    }
  }
  /// Of the newest diagnostics, after a pair.
  diagnostic_msgs::DiagnosticStatus status() {
    process(1);
    diagnostics_.clear();
    const auto array = diagnostics_.wait([](const DiagnosticArray& a) { return !find(a).name.empty(); });
    return array ? find(*array) : diagnostic_msgs::DiagnosticStatus();
  }
  static diagnostic_msgs::DiagnosticStatus find(const DiagnosticArray& array) {
    for (const auto& s : array.status) {
      if (s.name.find("disparity_nodelet: Disparity") != std::string::npos) return s;
    }
    return {};
  }
  double value(const std::string& key) {
    for (const auto& entry : status().values) {
      if (entry.key == key) return std::stod(entry.value);
    }
    ADD_FAILURE() << key;
    return 0.0;
  }
  double scale() { return value("Scale of the images matched"); }
  void setDeadline(double deadline_ms) {
    graph_.edit([&](dynamic_reconfigure::Config& config) {
      config.doubles.emplace_back();
      config.doubles.back().name = "deadline_ms";
      config.doubles.back().value = deadline_ms;
    });
  }
  bool scaleBecomes(double wanted, int most_pairs) {
    for (int i = 0; i < most_pairs; i += 5) {
      process(5);
      if (scale() == wanted) return true;
    }
    return false;
  }

  NodeletGraph graph_{"/deadline"};
  Inbox<DiagnosticArray> diagnostics_{ros::NodeHandle(), "/diagnostics"};
  int number_ = 0;
};

/// With deadlines that no machine keeps, or every one: what is tested is the way of the scale, not the machine.
TEST_F(DeadlineTest, GivesUpWhatItMustSaysSoAndReturns) {
  EXPECT_EQ(scale(), 1.0);
  setDeadline(0.01);
  EXPECT_TRUE(scaleBecomes(0.3, 100));
  process(30);
  const auto told = status();
  EXPECT_EQ(told.level, diagnostic_msgs::DiagnosticStatus::WARN);
  for (const char* part : {"deadline_ms = 0.01", "at 0.3 of their size, not 1", "late all the same"}) {
    EXPECT_NE(told.message.find(part), std::string::npos) << told.message;
  }
  setDeadline(10000.0);
  EXPECT_TRUE(scaleBecomes(1.0, 300));
  EXPECT_EQ(status().message, "Running");
}

TEST_F(DeadlineTest, OffIsWholeSizeAtOnce) {
  setDeadline(0.01);
  EXPECT_TRUE(scaleBecomes(0.3, 100));
  setDeadline(0.0);
  EXPECT_TRUE(scaleBecomes(1.0, 5));
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "deadline_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
