// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// No input kills or stops the nodelet: ten bad messages, then good ones; the next good pair comes out, a log line and
// the diagnostics name the topic, the value and the remedy.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using test::goodMessages;
using test::imageMessage;
using test::Inbox;
using test::LogLines;
using test::Messages;
using test::nextStamp;
using test::NodeletGraph;
using test::waitUntil;

struct Case {
  std::string name;
  std::function<void(Messages&)> spoil;
  std::vector<std::string> said;  ///< parts of one log line
};

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();
const std::string kLeft = "/robot/left/image_rect";
const std::string kRight = "/robot/right/image_rect";
const std::string kLeftInfo = "/robot/left/camera_info";
const std::string kRightInfo = "/robot/right/camera_info";

sensor_msgs::Image blank(int width, int height, int type, const std::string& encoding) {
  return imageMessage(cv::Mat(height, width, type, cv::Scalar::all(77)), encoding);
}

std::vector<Case> imageCases() {
  return {
      {"left one row more", [](Messages& m) { m.left = blank(160, 121, CV_8UC1, "mono8"); }, {"160 x 121", "one mode"}},
      {"right one row less",
       [](Messages& m) { m.right = blank(160, 119, CV_8UC1, "mono8"); },
       {"160 x 119", "one mode"}},
      {"left twice as wide",
       [](Messages& m) { m.left = blank(320, 120, CV_8UC1, "mono8"); },
       {"320 x 120", "one mode"}},
      {"left 0 x 0",
       [](Messages& m) {
         m.left = sensor_msgs::Image();
         m.left.encoding = "mono8";
       },
       {kLeft, "0 x 0"}},
      {"right 0 x 0",
       [](Messages& m) {
         m.right = sensor_msgs::Image();
         m.right.encoding = "mono8";
       },
       {kRight, "0 x 0"}},
      {"width 0", [](Messages& m) { m.left.width = 0; }, {kLeft, "0 x 120"}},
      {"height 0", [](Messages& m) { m.right.height = 0; }, {kRight, "160 x 0"}},
      {"no data", [](Messages& m) { m.left.data.clear(); }, {kLeft, "0 bytes", "19200"}},
      {"one byte missing", [](Messages& m) { m.right.data.pop_back(); }, {kRight, "19199", "truncated"}},
      {"half the data", [](Messages& m) { m.left.data.resize(9600); }, {kLeft, "9600 bytes"}},
      {"step 0", [](Messages& m) { m.left.step = 0; }, {kLeft, "step 0"}},
      {"step below the row", [](Messages& m) { m.left.step = 159; }, {kLeft, "step 159", "160 bytes"}},
      {"step of bytes for 16 bit", [](Messages& m) { m.right.encoding = "mono16"; }, {kRight, "step 160", "320 bytes"}},
      {"step beyond the data", [](Messages& m) { m.right.step = 1000; }, {kRight, "step 1000"}},
      {"largest step", [](Messages& m) { m.right.step = 0xFFFFFFFFU; }, {kRight, "4294967295"}},
      {"largest size",
       [](Messages& m) { m.left.width = m.left.height = m.left.step = 0xFFFFFFFFU; },
       {kLeft, "4294967295 x 4294967295"}},
      {"claims 100000 x 100000",
       [](Messages& m) { m.left.width = m.left.height = m.left.step = 100000; },
       {kLeft, "100000 x 100000"}},
      {"claims 60000 x 60000",
       [](Messages& m) { m.left.width = m.left.height = m.left.step = 60000; },
       {kLeft, "3600000000", "truncated"}},
      {"32FC1", [](Messages& m) { m.left = blank(160, 120, CV_32FC1, "32FC1"); }, {kLeft, "'32FC1'", "mono8"}},
      {"64FC1", [](Messages& m) { m.right = blank(160, 120, CV_64FC1, "64FC1"); }, {kRight, "'64FC1'", "mono8"}},
      {"8SC1", [](Messages& m) { m.left.encoding = "8SC1"; }, {kLeft, "'8SC1'"}},
      {"16SC1", [](Messages& m) { m.left.encoding = "16SC1"; }, {kLeft, "'16SC1'"}},
      {"32SC1", [](Messages& m) { m.left.encoding = "32SC1"; }, {kLeft, "'32SC1'"}},
      {"8UC2", [](Messages& m) { m.left.encoding = "8UC2"; }, {kLeft, "'8UC2'"}},
      {"8UC5", [](Messages& m) { m.left.encoding = "8UC5"; }, {kLeft, "'8UC5'"}},
      {"empty encoding", [](Messages& m) { m.left.encoding = ""; }, {kLeft, "encoding ''"}},
      {"unknown encoding", [](Messages& m) { m.right.encoding = "jpeg"; }, {kRight, "'jpeg'"}},
      {"long encoding", [](Messages& m) { m.right.encoding.assign(100000, 'x'); }, {kRight, "'xxxx"}},
      {"format string in the encoding", [](Messages& m) { m.right.encoding = "%s%n%s"; }, {kRight, "'%s%n%s'"}},
      {"terminal codes in the encoding",
       [](Messages& m) { m.left.encoding = "mono8\n\x1b[31m"; },
       {kLeft, "'mono8??[31m'"}},
      {"encoding with bytes 0", [](Messages& m) { m.left.encoding = std::string("mo\0no8", 6); }, {kLeft, "encoding"}},
      {"odd yuv422", [](Messages& m) { m.left = blank(159, 120, CV_8UC2, "yuv422"); }, {kLeft, "159", "even"}},
      {"8 and 16 bit",
       [](Messages& m) { m.left = blank(160, 120, CV_16UC1, "mono16"); },
       {kLeft, "16 bit", "one mode"}},
      {"colour data too short", [](Messages& m) { m.left.encoding = "bgr8"; }, {kLeft, "step 160", "480 bytes"}},
      {"bayer of 16 bit too short", [](Messages& m) { m.left.encoding = "bayer_rggb16"; }, {kLeft, "320 bytes"}},
      {"different patterns of bayer and sizes",
       [](Messages& m) {
         m.left = blank(160, 120, CV_8UC1, "bayer_rggb8");
         m.right = blank(120, 160, CV_8UC1, "bayer_bggr8");
       },
       {"160 x 120", "120 x 160", "one mode"}},
      {"an odd row of bytes for 16 bit",
       [](Messages& m) { m.left = blank(160, 120, CV_8UC1, "mono16"); },
       {kLeft, "320 bytes"}},
      {"very wide",
       [](Messages& m) { m.left = m.right = blank(65536, 1, CV_8UC1, "mono8"); },
       {kLeft, "65536 x 1", "65535"}},
      {"both one pixel",
       [](Messages& m) { m.left = m.right = blank(1, 1, CV_8UC1, "mono8"); },
       {kLeftInfo, "160 x 120", "1 x 1"}},
  };
}

std::vector<Case> calibrationCases() {
  return {
      {"left all 0", [](Messages& m) { m.left_info.P.fill(0.0); }, {kLeftInfo, "all 0", "camera_calibration"}},
      {"right all 0", [](Messages& m) { m.right_info.P.fill(0.0); }, {kRightInfo, "all 0", "camera_calibration"}},
      {"projection of nothing",
       [](Messages& m) {
         m.left_info.P.fill(0.0);
         m.left_info.P[10] = 1.0;
       },
       {kLeftInfo, "P[0] = 0, P[5] = 0"}},
      {"NaN focal length", [](Messages& m) { m.left_info.P[0] = kNan; }, {kLeftInfo, "P[0] = nan"}},
      {"NaN baseline", [](Messages& m) { m.right_info.P[3] = kNan; }, {kRightInfo, "P[3] = nan"}},
      {"NaN centre", [](Messages& m) { m.right_info.P[2] = kNan; }, {kRightInfo, "P[2] = nan"}},
      {"infinite baseline", [](Messages& m) { m.right_info.P[3] = -kInf; }, {kRightInfo, "P[3] = -inf"}},
      {"infinite focal length", [](Messages& m) { m.right_info.P[0] = kInf; }, {kRightInfo, "P[0] = inf"}},
      {"NaN at an unused place", [](Messages& m) { m.left_info.P[11] = kNan; }, {kLeftInfo, "P[11] = nan"}},
      {"fx 0", [](Messages& m) { m.left_info.P[0] = 0.0; }, {kLeftInfo, "P[0] = 0"}},
      {"fy 0", [](Messages& m) { m.right_info.P[5] = 0.0; }, {kRightInfo, "P[5] = 0"}},
      {"fx negative", [](Messages& m) { m.right_info.P[0] = -200.0; }, {kRightInfo, "P[0] = -200"}},
      {"no baseline", [](Messages& m) { m.right_info.P[3] = 0.0; }, {kRightInfo, "P[3] = 0", "baseline"}},
      {"left and right swapped", [](Messages& m) { m.right_info.P[3] = 20.0; }, {kRightInfo, "P[3] = 20", "swapped"}},
      {"both calibrations swapped", [](Messages& m) { std::swap(m.left_info, m.right_info); }, {kLeftInfo, "swapped"}},
      {"fx differs by 5 %", [](Messages& m) { m.left_info.P[0] = 210.0; }, {kLeftInfo, "fx = 210", "1 %"}},
      {"cy differs by 10 px", [](Messages& m) { m.left_info.P[6] += 10.0; }, {kLeftInfo, "cy = 70", "rows"}},
      {"left of another size",
       [](Messages& m) {
         m.left_info.width = 640;
         m.left_info.height = 480;
       },
       {kLeftInfo, "640 x 480", "160 x 120"}},
      {"right of another size", [](Messages& m) { m.right_info.width = 80; }, {kRightInfo, "80 x 120"}},
      {"binning that does not fit",
       [](Messages& m) { m.left_info.binning_x = m.left_info.binning_y = 2; },
       {kLeftInfo, "80 x 60", "binning"}},
      {"largest binning", [](Messages& m) { m.left_info.binning_x = 0xFFFFFFFFU; }, {kLeftInfo, "0 x 120"}},
      {"roi that does not fit", [](Messages& m) { m.right_info.roi.width = 100; }, {kRightInfo, "100 x 120", "roi"}},
      {"largest roi",
       [](Messages& m) { m.right_info.roi.width = m.right_info.roi.height = 0xFFFFFFFFU; },
       {kRightInfo, "4294967295"}},
      {"focal length of 1e300 px", [](Messages& m) { m.left_info.P[0] = 1e300; }, {kLeftInfo, "P[0] = 1e+300"}},
      {"centre at 1e300 px", [](Messages& m) { m.right_info.P[2] = 1e300; }, {kRightInfo, "P[2] = 1e+300"}},
      {"baseline of 1e300 m",
       [](Messages& m) { m.right_info.P[3] = -1e300; },
       {kRightInfo, "P[3] = -1e+300", "metres"}},
      {"baseline of 1e-300 m", [](Messages& m) { m.right_info.P[3] = -1e-300; }, {kRightInfo, "P[3] = -1e-300"}},
      {"largest offset of the roi",
       [](Messages& m) { m.left_info.roi.x_offset = 0xFFFFFFFFU; },
       {kLeftInfo, "-4.29", "roi"}},
      {"largest image size",
       [](Messages& m) { m.left_info.width = m.left_info.height = 0xFFFFFFFFU; },
       {kLeftInfo, "4294967295"}},
  };
}

/// Odd, but a disparity comes out of the bad messages too.
std::vector<Case> usableCases() {
  return {
      {"frames differ",
       [](Messages& m) { m.right_info.header.frame_id = "right_optical"; },
       {kRightInfo, "right_optical"}},
      {"fx differs by 0.5 %", [](Messages& m) { m.left_info.P[0] = 201.0; }, {kLeftInfo, "fx = 201"}},
      {"cy differs by 1 px", [](Messages& m) { m.left_info.P[6] += 1.0; }, {kLeftInfo, "cy = 61"}},
      {"size not set", [](Messages& m) { m.left_info.width = m.left_info.height = 0; }, {kLeftInfo, "not set"}},
      {"grey and colour", [](Messages& m) { m.right = blank(160, 120, CV_8UC3, "bgr8"); }, {kLeft, "bgr8", "grey"}},
      {"empty frame of one", [](Messages& m) { m.right_info.header.frame_id = ""; }, {kRightInfo, "frame_id ''"}},
      {"empty frames",
       [](Messages& m) {
         for (auto* h : {&m.left.header, &m.right.header, &m.left_info.header, &m.right_info.header}) h->frame_id = "";
       },
       {kLeft, "frame_id ''", "empty"}},
      {"frames of 100 kB",
       [](Messages& m) { m.right_info.header.frame_id.assign(100000, 'f'); },
       {kRightInfo, "'ffff", "differs"}},
  };
}

bool diagnosed(const Case& c, const diagnostic_msgs::DiagnosticArray& array) {
  for (const auto& status : array.status) {
    const auto has = [&](const std::string& part) { return status.message.find(part) != std::string::npos; };
    if (status.level != diagnostic_msgs::DiagnosticStatus::OK && std::all_of(c.said.begin(), c.said.end(), has)) {
      return true;
    }
  }
  return false;
}

/// The cases share a nodelet; it is loaded anew now and then because it bounds its lines in the log.
class BadInput : public ::testing::TestWithParam<Case> {
 protected:
  static constexpr int kCasesPerNodelet = 15;

  static void SetUpTestSuite() { cases_run_ = 0; }
  static void TearDownTestSuite() { graph_.reset(); }
  void SetUp() override {
    if (cases_run_++ % kCasesPerNodelet == 0) {
      graph_.reset();
      graph_ = std::make_unique<NodeletGraph>("/robot");
    }
    ASSERT_TRUE(graph_->process(goodMessages())) << "the good pair before the bad ones";
  }

  void sendTenTimes() {
    for (int i = 0; i < 10; ++i) {
      Messages messages = goodMessages();
      messages.stamp(nextStamp());
      const ros::Time stamp = messages.left.header.stamp;
      GetParam().spoil(messages);
      messages.left.header.stamp = messages.right.header.stamp = stamp;
      graph_->camera().publish(messages);
      ros::WallDuration(0.003).sleep();
    }
  }

  void expectSaid() {
    EXPECT_NE(log_.wait(GetParam().said), "");
    EXPECT_TRUE(diagnostics_.wait([](const auto& array) { return diagnosed(GetParam(), array); }));
  }

  static int cases_run_;
  static std::unique_ptr<NodeletGraph> graph_;
  LogLines log_;
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics_{ros::NodeHandle(), "/diagnostics"};
};
int BadInput::cases_run_ = 0;
std::unique_ptr<NodeletGraph> BadInput::graph_;

class UnusableInput : public BadInput {};
class UsableInput : public BadInput {};

TEST_P(UnusableInput, IsSaidAndRecoveredFrom) {
  sendTenTimes();
  expectSaid();
  EXPECT_TRUE(graph_->process(goodMessages())) << "does not recover";
}

TEST_P(UsableInput, GivesADisparityAndAWarning) {
  Messages messages = goodMessages();
  GetParam().spoil(messages);
  const auto disparity = graph_->process(messages);
  ASSERT_TRUE(disparity);
  EXPECT_FLOAT_EQ(disparity->f, test::kFocal);
  expectSaid();
}

/// Stamps that may be anything reach the synchronisers, which compute with them.
class HostileStamps : public ::testing::TestWithParam<bool> {};

TEST_P(HostileStamps, DoNotStopIt) {
  NodeletGraph graph("/stamps", {{"approximate_sync", GetParam()}, {"max_rate", 1000.0}, {"max_age", 3600.0}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  const std::uint32_t kSeconds[] = {0U, 1U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU};
  const std::uint32_t kNanoseconds[] = {0U, 1U, 999999999U, 0xFFFFFFFFU};
  std::mt19937 random(1);
  Messages messages = goodMessages();
  for (int i = 0; i < 300; ++i) {
    for (auto* header :
         {&messages.left.header, &messages.right.header, &messages.left_info.header, &messages.right_info.header}) {
      if (random() % 4 == 0) header->stamp.sec = kSeconds[random() % 5];
      if (random() % 4 == 0) header->stamp.nsec = kNanoseconds[random() % 4];
    }
    if (i % 10 == 0) messages.stamp(ros::Time(messages.left.header.stamp.sec, 0));
    graph.camera().publish(messages);
    ros::WallDuration(0.002).sleep();
  }
  ros::Time sent;
  const auto recovered = [&] {
    sent = ros::Time::now();
    messages.stamp(sent);
    graph.camera().publish(messages);
    return graph.disparity().wait([&](const auto& d) { return d.header.stamp == sent; }, 0.5) != nullptr;
  };
  EXPECT_TRUE(waitUntil(recovered));
}

/// A driver that does not stamp its images: every pair is used, and it is said.
TEST_P(HostileStamps, NoStampsAtAll) {
  LogLines log;
  NodeletGraph graph("/unstamped", {{"approximate_sync", GetParam()}, {"max_rate", 10.0}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  Messages messages = goodMessages();
  messages.stamp(ros::Time());
  for (std::size_t i = 1; i <= 3; ++i) {
    const auto came = [&] {
      graph.camera().publish(messages);
      return waitUntil([&] { return graph.disparity().count() >= i; }, 0.3);
    };
    EXPECT_TRUE(waitUntil(came)) << i;
  }
  EXPECT_NE(log.wait({"/unstamped/left/image_rect", "stamp is 0", "driver"}), "");
}

INSTANTIATE_TEST_SUITE_P(Sync, HostileStamps, ::testing::Bool(),
                         [](const auto& sync) { return sync.param ? "Approximate" : "Exact"; });

std::string testName(const ::testing::TestParamInfo<Case>& info) {
  std::string name;
  for (const char c : info.param.name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Image, UnusableInput, ::testing::ValuesIn(imageCases()), testName);
INSTANTIATE_TEST_SUITE_P(Calibration, UnusableInput, ::testing::ValuesIn(calibrationCases()), testName);
INSTANTIATE_TEST_SUITE_P(Odd, UsableInput, ::testing::ValuesIn(usableCases()), testName);

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_input_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
