// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/io.hpp"
#include "messages.hpp"

namespace fdp_stereo {
namespace {

constexpr double kSeconds = 2.0;

Observation healthy() {
  Observation seen;
  seen.seconds = kSeconds;
  const char* topics[] = {"/cam/left/image_rect", "/cam/left/camera_info", "/cam/right/image_rect",
                          "/cam/right/camera_info"};
  for (std::size_t i = 0; i < 4; ++i) {
    seen.inputs[i].topic = topics[i];
    seen.inputs[i].publishers = 1;
    for (int k = 0; k < 20; ++k) seen.inputs[i].stamps.emplace_back(100.0 + 0.1 * k);
  }
  seen.pair = test::goodMessages(320, 240).frame();
  seen.disparity_publishers = 1;
  seen.disparities = 20;
  seen.node = "/cam/disparity";
  seen.range = {0, 64};
  return seen;
}

/// Text and remedy of the first finding with the verdict, "" where there is none.
std::string first(const Observation& seen, Verdict verdict) {
  for (const Finding& finding : diagnose(seen)) {
    if (finding.verdict == verdict) return finding.text + " -> " + finding.remedy;
  }
  return "";
}

void expectContains(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' in: " << text;
}

TEST(Diagnose, AHealthyCamera) {
  for (const Finding& finding : diagnose(healthy())) {
    EXPECT_EQ(finding.verdict, Verdict::kGood) << finding.text;
    EXPECT_EQ(finding.remedy, "");
  }
  EXPECT_GE(diagnose(healthy()).size(), 8U);
}

TEST(Diagnose, MissingTopics) {
  Observation seen = healthy();
  seen.inputs[2].stamps.clear();
  expectContains(first(seen, Verdict::kWrong),
                 {"/cam/right/image_rect has a publisher", "rostopic info /cam/right/image_rect"});
  seen.inputs[2].publishers = 0;
  expectContains(first(seen, Verdict::kWrong), {"/cam/right/image_rect has no publisher", "rostopic list"});
}

TEST(Diagnose, StampsThatDoNotMeet) {
  Observation seen = healthy();
  seen.disparities = 0;
  for (auto& stamp : seen.inputs[2].stamps) stamp += ros::Duration(0.008);
  expectContains(first(seen, Verdict::kWrong), {"only 0 %", "/cam/right/image_rect", "8 ms", "approximate_sync:=true"});
}

/// A node that pairs near stamps, and does.
TEST(Diagnose, ApproximateSyncThatWorks) {
  Observation seen = healthy();
  for (auto& stamp : seen.inputs[2].stamps) stamp += ros::Duration(0.008);
  seen.approximate_sync = true;
  EXPECT_EQ(first(seen, Verdict::kWrong) + first(seen, Verdict::kOdd), "");
  seen.disparities = 0;
  expectContains(first(seen, Verdict::kWrong), {"8 ms", "queue_size"});
  seen.tolerance_s = 0.005;
  expectContains(first(seen, Verdict::kWrong), {"8 ms", "approximate_sync_tolerance above 0.008 s"});
}

/// Throttled on either side, or a camera_info that is sent once.
TEST(Diagnose, UnequalRates) {
  for (const std::size_t slow : {0U, 1U, 2U, 3U}) {
    Observation seen = healthy();
    auto& stamps = seen.inputs[slow].stamps;
    for (std::size_t i = 0; i < stamps.size(); ++i) stamps.erase(stamps.begin() + static_cast<std::ptrdiff_t>(i));
    seen.disparities = 10;
    EXPECT_EQ(first(seen, Verdict::kWrong), "") << slow;
    expectContains(first(seen, Verdict::kOdd),
                   {"the rates differ", "20 ", "10 ", "than messages of " + seen.inputs[slow].topic});
  }
  Observation once = healthy();
  once.inputs[3].stamps = {ros::Time(99.0)};
  once.disparities = 0;
  expectContains(first(once, Verdict::kOdd), {"1 of /cam/right/camera_info"});
  expectContains(first(once, Verdict::kWrong), {"only 0 %", "/cam/right/camera_info", "stamp of its image"});
}

TEST(Diagnose, ViewsThatAreSwapped) {
  Observation seen = healthy();
  auto messages = test::goodMessages(320, 240);
  std::swap(messages.left, messages.right);
  seen.pair = messages.frame();
  expectContains(first(seen, Verdict::kWrong),
                 {"images are swapped", "beyond infinity", "exchange /cam/left/image_rect and /cam/right/image_rect"});
}

/// The sample pair, whose principal points differ: exchanged, only its far half lies beyond infinity.
TEST(Diagnose, ViewsOfVergedCamerasThatAreSwapped) {
  const std::string folder = FDP_STEREO_SOURCE_DIR "/sample/motorcycle/";
  const cv::Mat left = readImage(folder + "left.png");
  const cv::Mat right = readImage(folder + "right.png");
  test::Messages messages{test::imageMessage(left, "bgr8"), test::imageMessage(right, "bgr8"),
                          test::cameraInfo(left.cols, left.rows, 994.978, 311.193, 254.877, 0.0),
                          test::cameraInfo(left.cols, left.rows, 994.978, 342.279, 254.877, -994.978 * 0.193001)};
  Observation seen = healthy();
  seen.pair = messages.frame();
  EXPECT_EQ(first(seen, Verdict::kWrong), "");
  std::swap(messages.left, messages.right);
  seen.pair = messages.frame();
  expectContains(first(seen, Verdict::kWrong), {"images are swapped"});
}

/// Principal points that differ: negative disparities are near things.
TEST(Diagnose, VergedCamerasAreNotSwapped) {
  Observation seen = healthy();
  auto messages = test::goodMessages(320, 240);
  std::swap(messages.left, messages.right);
  messages.right_info.P[2] += 30.0;
  seen.pair = messages.frame();
  seen.range = {-29, 64};
  EXPECT_EQ(first(seen, Verdict::kWrong), "");
}

TEST(Diagnose, CalibrationThatCannotBeUsedOrIsOdd) {
  Observation seen = healthy();
  auto messages = test::goodMessages(320, 240);
  messages.right_info.P[3] = 0.0;
  seen.pair = messages.frame();
  expectContains(first(seen, Verdict::kWrong),
                 {"/cam/right/camera_info", "baseline is 0", "rostopic echo -n 1 --noarr /cam/right/camera_info"});
  messages = test::goodMessages(320, 240);
  messages.right_info.header.frame_id = "other";
  seen.pair = messages.frame();
  expectContains(first(seen, Verdict::kOdd), {"frame_id 'other'"});
}

TEST(Diagnose, RowsThatAreOff) {
  Observation seen = healthy();
  auto messages = test::goodMessages(320, 240);
  cv::Mat right = decodeImage(messages.right, "");
  cv::Mat moved;
  cv::warpAffine(right, moved, cv::Matx23d(1, 0, 0, 0, 1, 3), right.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  messages.right = test::imageMessage(moved, "mono8");
  seen.pair = messages.frame();
  expectContains(first(seen, Verdict::kWrong), {"rows", "off by", "calibrat"});
}

TEST(Diagnose, RangeThatMissesTheScene) {
  Observation seen = healthy();
  seen.range = {16, 32};
  expectContains(first(seen, Verdict::kWrong),
                 {"100 %", "16 to 47 px", "dynparam set /cam/disparity", "min_disparity: 5"});
}

TEST(Diagnose, RangeOutsideTheImage) {
  Observation seen = healthy();
  seen.range = {320, 64};
  expectContains(first(seen, Verdict::kWrong), {"min_disparity = 320", "320 px wide", "dynparam set /cam/disparity"});
}

TEST(Diagnose, SaysHowNearItSees) {
  const auto findings = diagnose(healthy());
  EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.text.find("sees from 0.317 m (disparities 0 to 63 px)") != std::string::npos;
  }));
}

TEST(Diagnose, NoTextureAndNoOutput) {
  Observation seen = healthy();
  auto messages = test::goodMessages(320, 240);
  messages.left = messages.right = test::imageMessage(cv::Mat(240, 320, CV_8UC1, cv::Scalar(90)), "mono8");
  seen.pair = messages.frame();
  seen.disparities = 0;
  expectContains(first(seen, Verdict::kOdd), {"only 0 matches", "texture"});
  expectContains(first(seen, Verdict::kWrong), {"no disparity came from /cam/disparity", "/diagnostics"});
}

/// The last finding is about the node, whatever is wrong before it.
TEST(Diagnose, TheNodeItself) {
  Observation seen = healthy();
  seen.disparities = 0;
  seen.inputs[0].stamps.clear();
  expectContains(diagnose(seen).back().remedy, {"WRONG above first"});
  seen.disparity_publishers = 0;
  expectContains(diagnose(seen).back().text, {"/cam/disparity does not run"});
  expectContains(diagnose(seen).back().remedy, {"roslaunch fdp_stereo stereo.launch"});
}

}  // namespace
}  // namespace fdp_stereo
