// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "node_status.hpp"

#include <gtest/gtest.h>

namespace fdp_stereo {
namespace {

using diagnostic_msgs::DiagnosticStatus;

class Status : public ::testing::Test {
 protected:
  Status() {
    before_.subscribed = true;
    const char* topics[] = {"/cam/left/image_rect", "/cam/left/camera_info", "/cam/right/image_rect",
                            "/cam/right/camera_info"};
    for (std::size_t i = 0; i < 4; ++i) before_.inputs[i] = {topics[i], 1, {100, ros::Time(50.0)}};
    now_ = before_;
    for (auto& input : now_.inputs) input.count.received = 250;
  }
  std::string silence() const { return describeSilence(now_, before_, 15.0); }
  std::string summary() const {
    diagnostic_updater::DiagnosticStatusWrapper diagnostics;
    describeStatus(now_, before_, 15.0, diagnostics);
    return diagnostics.message;
  }
  std::string value(const std::string& key) const {
    diagnostic_updater::DiagnosticStatusWrapper diagnostics;
    describeStatus(now_, before_, 15.0, diagnostics);
    for (const auto& entry : diagnostics.values) {
      if (entry.key == key) return entry.value;
    }
    return "no such key: " + key;
  }
  NodeStatus before_, now_;
};

void expectContains(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' in: " << text;
}

TEST_F(Status, NoSilenceWhileFramesComeOut) {
  now_.pairs = now_.processed = 1;
  EXPECT_EQ(silence(), "");
}

TEST_F(Status, NoSilenceWhereNobodyListens) {
  now_.subscribed = false;
  EXPECT_EQ(silence(), "");
  now_.subscribed = true;
  before_.subscribed = false;
  EXPECT_EQ(silence(), "") << "only just subscribed";
}

TEST_F(Status, SilenceOfATopicWithoutPublisher) {
  now_.inputs[3].count.received = 100;
  now_.inputs[3].publishers = 0;
  expectContains(silence(), {"15 s", "/cam/left/image_rect 150", "/cam/right/camera_info 0",
                             "/cam/right/camera_info has no publisher", "rostopic list"});
}

TEST_F(Status, SilenceOfATopicThatSendsNothing) {
  now_.inputs[2].count.received = 100;
  expectContains(silence(), {"/cam/right/image_rect has a publisher that sends nothing", "rostopic hz"});
}

TEST_F(Status, SilenceOfStampsThatDoNotMeet) {
  now_.inputs[2].count.stamp = now_.inputs[3].count.stamp = ros::Time(50.0125);
  expectContains(silence(), {"/cam/left/image_rect and /cam/right/image_rect", "12.5 ms", "~approximate_sync"});
  now_.approximate_sync = true;
  expectContains(silence(), {"12.5 ms", "~approximate_sync_tolerance"});
}

TEST_F(Status, SilenceOfPairsThatCannotBeUsed) {
  now_.pairs = 150;
  now_.failed = 150;
  now_.last_error = "/cam/right/camera_info: P is all 0";
  expectContains(silence(), {"150 pairs", "none could be used", "P is all 0"});
}

TEST_F(Status, NoSilenceWhileALongFrameRuns) {
  now_.pairs = 1;
  EXPECT_EQ(silence(), "");
}

TEST_F(Status, Summaries) {
  EXPECT_EQ(summary(), "No synchronised pair yet");
  now_.pairs = now_.processed = 30;
  EXPECT_EQ(summary(), "Running");
  now_.frame.warnings = {"fx differs", "rows are off"};
  EXPECT_EQ(summary(), "fx differs; rows are off");
  now_.error_is_current = true;
  now_.last_error = "encoding '32FC1'";
  EXPECT_EQ(summary(), "encoding '32FC1'");
  now_.subscribed = false;
  EXPECT_EQ(summary(), "Idle: no output has a subscriber");
  now_.master_lost = true;
  EXPECT_EQ(summary(), "The ROS master does not answer");
}

TEST_F(Status, Values) {
  now_.processed = 30;
  now_.dropped = 7;
  now_.latency_ms = 41.26;
  now_.revision = 3;
  now_.frame.pipeline.times = {{"optimizer", 20.04}};
  now_.frame.pipeline.row_alignment.note = "affine row offset, 0.52 px RMS";
  now_.frame.pipeline.row_alignment.rms_before_px = 0.6;
  now_.frame.pipeline.row_alignment.rms_after_px = 0.114;
  now_.frame.notes = {"sees from 0.76 m"};
  EXPECT_EQ(value("/cam/left/image_rect"), "250 received, 10.0 Hz");
  EXPECT_EQ(value("Output rate (Hz)"), "2.00");
  EXPECT_EQ(value("Pairs dropped (overload)"), "7");
  EXPECT_EQ(value("Latency (ms)"), "41.3");
  EXPECT_EQ(value("Stage optimizer (ms)"), "20.0");
  EXPECT_EQ(value("Parameter revision"), "3");
  now_.apart_ms = 40.04;
  EXPECT_EQ(value("Stamps of left and right apart (ms)"), "40.0");
  now_.age_ms = 51.26;
  EXPECT_EQ(value("Age of the output (ms)"), "51.3");
  for (const double another_clock : {1.77e12, -1.77e12}) {
    now_.age_ms = another_clock;
    expectContains(value("Age of the output (ms)"), {"unknown", "--clock"});
  }
  EXPECT_EQ(value("Row alignment"), "affine row offset, 0.52 px RMS");
  EXPECT_EQ(value("Row residuals before and after (px)"), "0.60, 0.11");
  EXPECT_EQ(value("Notes"), "sees from 0.76 m");
}

TEST(LogThrottle, SaysATextOnceWhileItKeepsComing) {
  LogThrottle throttle(std::chrono::seconds(10), 3);
  const LogThrottle::Clock::time_point start{};
  EXPECT_TRUE(throttle.allow("a", start));
  for (const int second : {5, 9, 18, 27, 36}) EXPECT_FALSE(throttle.allow("a", start + std::chrono::seconds(second)));
  EXPECT_TRUE(throttle.allow("b", start + std::chrono::seconds(36)));
  EXPECT_TRUE(throttle.allow("a", start + std::chrono::seconds(46))) << "it was away";
}

TEST(LogThrottle, BoundsTextsThatAlwaysDiffer) {
  LogThrottle throttle(std::chrono::seconds(10), 3);
  const LogThrottle::Clock::time_point start{};
  int lines = 0;
  for (int i = 0; i < 1000; ++i) lines += throttle.allow(std::to_string(i), start) ? 1 : 0;
  EXPECT_EQ(lines, 3);
  EXPECT_TRUE(throttle.allow("later", start + std::chrono::seconds(10)));
}

TEST_F(Status, TheMemoryOfTheStreamIsTold) {
  now_.frame.pipeline.temporal.kept_share = 0.875;
  now_.frame.pipeline.temporal.repeated = true;
  now_.temporal_resets = 3;
  now_.last_temporal_reset = "the view changed";
  EXPECT_EQ(value("Pixels kept from earlier pairs (%)"), "87.5");
  EXPECT_EQ(value("Result of the pair before repeated"), "yes");
  EXPECT_EQ(value("Pairs without memory of earlier ones"), "3");
  EXPECT_EQ(value("Why, the last time"), "the view changed");
}

}  // namespace
}  // namespace fdp_stereo
