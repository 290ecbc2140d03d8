// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <dynamic_reconfigure/config_tools.h>
#include <gtest/gtest.h>
#include <image_transport/image_transport.h>
#include <sensor_msgs/PointCloud2.h>
#include <opencv2/imgproc.hpp>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "frame_processor.hpp"
#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

using dynamic_reconfigure::ConfigTools;
using test::goodMessages;
using test::Inbox;
using test::LogLines;
using test::Messages;
using test::nextStamp;
using test::NodeletGraph;
using test::waitUntil;

cv::Mat pixels(const sensor_msgs::Image& image) {
  return cv::Mat(static_cast<int>(image.height), static_cast<int>(image.width), CV_32FC1,
                 const_cast<std::uint8_t*>(image.data.data()), image.step);
}

/// The pair of sample/, as a colour camera publishes it.
Messages sampleMessages() {
  const std::string folder = FDP_STEREO_SOURCE_DIR "/sample/motorcycle/";
  const cv::Mat left = readImage(folder + "left.png");
  const cv::Mat right = readImage(folder + "right.png");
  return {test::imageMessage(left, "bgr8"), test::imageMessage(right, "bgr8"),
          test::cameraInfo(left.cols, left.rows, 994.978, 311.193, 254.877, 0.0),
          test::cameraInfo(left.cols, left.rows, 994.978, 342.279, 254.877, -994.978 * 0.193001)};
}

TEST(DisparityNodelet, SamplePairEqualsTheCore) {
  NodeletGraph graph("/sample", {{"disparity_range", 64}});
  const Messages messages = sampleMessages();
  const auto received = graph.process(messages, 60.0);
  ASSERT_TRUE(received);

  Pipeline pipeline(loadPreset("fast"));
  const cv::Mat core = pipeline.run(decodeImage(messages.left, ""), decodeImage(messages.right, "")).disparity;
  const cv::Mat got = pixels(received->image);
  ASSERT_EQ(got.size(), core.size());
  const double offset = 311.193 - 342.279;
  int different = 0;
  int valid = 0;
  for (int y = 0; y < core.rows; ++y) {
    for (int x = 0; x < core.cols; ++x) {
      const float d = core.at<float>(y, x);
      const bool seen = !std::isnan(d);
      const float expected = seen ? static_cast<float>(d - offset) : static_cast<float>(0.0 - offset) - 1.0F;
      valid += seen ? 1 : 0;
      different += got.at<float>(y, x) != expected ? 1 : 0;
    }
  }
  EXPECT_EQ(different, 0);
  EXPECT_GT(valid, core.total() / 2);
  EXPECT_FLOAT_EQ(received->f, 994.978F);
  EXPECT_FLOAT_EQ(received->T, 0.193001F);
}

/// Share of the pixels of `reference` that `got` has within 1 px.
double agreement(const cv::Mat& got, const cv::Mat& reference) {
  const cv::Mat known = reference == reference;
  const cv::Mat same = known & (cv::abs(got - reference) <= 1.0);
  return static_cast<double>(cv::countNonZero(same)) / cv::countNonZero(known);
}

TEST(DisparityNodelet, AStreamOfMisalignedCamerasRecovers) {
  Messages messages = sampleMessages();
  messages.right_info.P[2] = messages.left_info.P[2];  // published disparities are then the matched ones
  const cv::Mat left = decodeImage(messages.left, "").clone();
  const cv::Mat right = decodeImage(messages.right, "").clone();
  const cv::Mat straight = Pipeline(loadPreset("fast")).run(left, right).disparity;
  // Rows off by 1 px in the middle, +- 0.7 px towards the corners.
  const cv::Mat rows = (cv::Mat_<double>(2, 3) << 1.0, 0.0, 0.0, 0.001, 1.001, 0.35);
  cv::Mat bent;
  cv::warpAffine(right, bent, rows, right.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  const sensor_msgs::Image good_right = messages.right;
  messages.right = test::imageMessage(bent, "bgr8");

  double off = 0.0;
  {
    NodeletGraph graph("/bent_off", {{"disparity_range", 64}, {"row_alignment_enabled", false}});
    const auto received = graph.process(messages, 60.0);
    ASSERT_TRUE(received);
    off = agreement(pixels(received->image), straight);
  }
  EXPECT_LT(off, 0.8) << "the stream is not misaligned enough to show anything";

  // Straight at first, so that the estimate has to let go of what it knew.
  NodeletGraph graph("/bent", {{"disparity_range", 64}, {"row_alignment_mode", 1}});
  Messages straight_messages = messages;
  straight_messages.right = good_right;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(graph.process(straight_messages, 60.0));
  double on = 0.0;
  for (int i = 0; i < 10; ++i) {
    const auto received = graph.process(messages, 60.0);
    ASSERT_TRUE(received);
    on = agreement(pixels(received->image), straight);
  }
  EXPECT_GT(on, 0.93);
  EXPECT_GT(on, off + 0.1);
}

TEST(DisparityNodelet, SubscribesOnlyWhileSomebodyListens) {
  NodeletGraph graph("/lazy");
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  graph.disparity().close();
  EXPECT_TRUE(graph.camera().waitForSubscribers(0));
  Inbox<sensor_msgs::Image> depth(graph.node(), "depth");
  EXPECT_TRUE(graph.camera().waitForSubscribers(4));
  depth.close();
  EXPECT_TRUE(graph.camera().waitForSubscribers(0));
  Inbox<sensor_msgs::Image> colours(graph.node(), "disparity_color");
  EXPECT_TRUE(graph.camera().waitForSubscribers(4));
  colours.close();
  EXPECT_TRUE(graph.camera().waitForSubscribers(0));
  graph.disparity().open();
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  EXPECT_TRUE(graph.process(goodMessages()));
}

TEST(DisparityNodelet, DepthAndConfidence) {
  NodeletGraph graph("/outputs");
  Inbox<sensor_msgs::Image> depth(graph.node(), "depth/image_rect");
  Inbox<sensor_msgs::CameraInfo> info(graph.node(), "depth/camera_info");
  Inbox<sensor_msgs::Image> confidence(graph.node(), "confidence");
  const auto connected = [&] {
    return depth.publishers() == 1 && info.publishers() == 1 && confidence.publishers() == 1;
  };
  ASSERT_TRUE(waitUntil(connected));
  const auto disparity = graph.process(goodMessages());
  ASSERT_TRUE(disparity);
  const auto same_stamp = [&](const auto& m) { return m.header.stamp == disparity->header.stamp; };
  const auto depth_image = depth.wait(same_stamp);
  ASSERT_TRUE(depth_image);
  EXPECT_NEAR(pixels(*depth_image).at<float>(60, 80), test::kFocal * test::kBaseline / test::kPlaneDisparity, 0.05);
  EXPECT_TRUE(info.wait(same_stamp));
  const auto confidence_image = confidence.wait(same_stamp);
  ASSERT_TRUE(confidence_image);
  double lowest = 0.0;
  double highest = 0.0;
  cv::minMaxLoc(pixels(*confidence_image), &lowest, &highest);
  EXPECT_GE(lowest, 0.0);
  EXPECT_GT(highest, 0.0);
  EXPECT_LE(highest, 1.0);
}

/// As depth_image_proc and other consumers subscribe: camera_info is looked for beside the image.
TEST(DisparityNodelet, DepthForACameraSubscriber) {
  NodeletGraph graph("/camera_subscriber");
  image_transport::ImageTransport transport(graph.node());
  std::atomic<int> received{0};
  double depth = 0.0;
  image_transport::CameraSubscriber subscriber = transport.subscribeCamera(
      "depth/image_rect", 5, [&](const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info) {
        EXPECT_EQ(image->header.stamp, info->header.stamp);
        EXPECT_EQ(info->P[0], test::kFocal);
        if (received == 0) depth = pixels(*image).at<float>(60, 80);
        ++received;
      });
  EXPECT_EQ(subscriber.getInfoTopic(), "/camera_subscriber/depth/camera_info");
  const auto came = [&] {
    graph.process(goodMessages());
    return received > 0;
  };
  EXPECT_TRUE(waitUntil(came));
  subscriber.shutdown();
  EXPECT_NEAR(depth, test::kFocal * test::kBaseline / test::kPlaneDisparity, 0.05);
}

TEST(DisparityNodelet, TheOldNameOfDepthBringsTheSame) {
  NodeletGraph graph("/old_name");
  Inbox<sensor_msgs::Image> depth(graph.node(), "depth/image_rect");
  Inbox<sensor_msgs::Image> old(graph.node(), "depth");
  ASSERT_TRUE(waitUntil([&] { return depth.publishers() == 1 && old.publishers() == 1; }));
  const auto disparity = graph.process(goodMessages());
  ASSERT_TRUE(disparity);
  const auto same_stamp = [&](const auto& m) { return m.header.stamp == disparity->header.stamp; };
  const auto by_new_name = depth.wait(same_stamp);
  const auto by_old_name = old.wait(same_stamp);
  ASSERT_TRUE(by_new_name && by_old_name);
  EXPECT_EQ(by_new_name->data, by_old_name->data);
}

TEST(DisparityNodelet, ColoursForPlainImageViewers) {
  NodeletGraph graph("/colours");
  Inbox<sensor_msgs::Image> colours(graph.node(), "disparity_color");
  ASSERT_TRUE(waitUntil([&] { return colours.publishers() == 1; }));
  const auto disparity = graph.process(goodMessages());
  ASSERT_TRUE(disparity);
  const auto image = colours.wait([&](const auto& m) { return m.header.stamp == disparity->header.stamp; });
  ASSERT_TRUE(image);
  EXPECT_EQ(image->encoding, "bgr8");
  EXPECT_EQ(image->header.frame_id, disparity->header.frame_id);
  const cv::Mat expected = colorize(fromDisparityMessage(*disparity, {}, "disparity"), {0, 32});
  const cv::Mat received(expected.rows, expected.cols, CV_8UC3, const_cast<std::uint8_t*>(image->data.data()));
  EXPECT_EQ(cv::norm(received, expected, cv::NORM_INF), 0.0);
}

TEST(DisparityNodelet, ALiveEditTakesEffectAndIsWrittenBack) {
  NodeletGraph graph("/live");
  const auto before = graph.process(goodMessages());
  ASSERT_TRUE(before);
  EXPECT_FLOAT_EQ(before->max_disparity, 31.0F);
  const auto answer = graph.edit([](auto& config) {
    ConfigTools::appendParameter(config, "disparity_range", 20);
    ConfigTools::appendParameter(config, "min_disparity", 99999);
    ConfigTools::appendParameter(config, "matching_cost_census_width", 8);
  });
  int value = 0;
  ASSERT_TRUE(ConfigTools::getParameter(answer, "min_disparity", value));
  EXPECT_EQ(value, 1024) << "clamped";
  ASSERT_TRUE(ConfigTools::getParameter(answer, "matching_cost_census_width", value));
  EXPECT_EQ(value, 5) << "refused";
  graph.edit([](auto& config) { ConfigTools::appendParameter(config, "min_disparity", 2); });
  const auto after = graph.process(goodMessages());
  ASSERT_TRUE(after);
  EXPECT_FLOAT_EQ(after->min_disparity, 2.0F);
  EXPECT_FLOAT_EQ(after->max_disparity, 21.0F);
  ros::param::get(graph.nodeletName() + "/disparity_range", value);
  EXPECT_EQ(value, 20);
}

TEST(DisparityNodelet, AStreamIsThatOfTheProcessorToTheBitAndForgetsOverJumps) {
  NodeletGraph graph("/stream");
  ASSERT_TRUE(graph.process(goodMessages()));
  NodeSettings settings;
  settings.pipeline = loadPreset("fast");
  settings.pipeline.search = {0, 32};
  FrameProcessor processor({});
  double time = 500.0;  // before the stamps of the pair above
  for (int i = 0; i < 12; ++i) {
    time += i == 8 ? 1.5 : i == 10 ? -20.0 : 0.05;
    if (i == 6) {
      graph.edit([](dynamic_reconfigure::Config& config) { ConfigTools::appendParameter(config, "speckle_size", 61); });
      settings.pipeline.speckle_filter.max_size = 61;
      ++settings.revision;
    }
    const Messages messages = test::noisyMessages(i, time);
    graph.camera().publish(messages);
    const auto got = graph.disparity().wait([&](const auto& d) { return d.header.stamp == ros::Time(time); });
    ASSERT_TRUE(got) << i;
    const FrameOutput expected = processor.process(messages.frame(), settings, {true});
    const std::string& reset = expected.report.pipeline.temporal.reset;
    EXPECT_EQ(reset.empty(), i != 0 && i != 6 && i != 8 && i != 10) << i << ": " << reset;
    EXPECT_EQ(got->image.data, expected.disparity->image.data) << i;
  }
}

TEST(DisparityNodelet, PresetThenParametersThenWhatWasUnknownIsSaid) {
  LogLines log;
  NodeletGraph graph("/preset", {{"preset", std::string("paper")}, {"semi_global_p2", 9.0}, {"not_there", 1}});
  std::string type;
  int cost = -1;
  double p2 = 0.0;
  ros::param::get(graph.nodeletName() + "/feature_matching_detector", cost);
  EXPECT_EQ(cost, static_cast<int>(loadPreset("paper").feature_matching.detector));
  ros::param::get(graph.nodeletName() + "/semi_global_p2", p2);
  EXPECT_DOUBLE_EQ(p2, 9.0);
  EXPECT_NE(log.wait({"not_there", "no effect"}), "");
  EXPECT_TRUE(graph.process(goodMessages()));
}

TEST(DisparityNodelet, ABadPresetFallsBackAndSaysSo) {
  LogLines log;
  NodeletGraph graph("/bad_preset", {{"preset", std::string("fsat")}});
  EXPECT_NE(log.wait({"~preset", "fsat", "using fast"}), "");
  EXPECT_TRUE(graph.process(goodMessages()));
}

/// roslaunch starts nodes in a folder of its own.
TEST(DisparityNodelet, APresetWithARelativeNameTellsWhereItLooked) {
  LogLines log;
  NodeletGraph graph("/relative_preset", {{"preset", std::string("my.yaml")}});
  EXPECT_NE(log.wait({"~preset", "my.yaml", "looked in " + std::filesystem::current_path().string(), "using fast"}),
            "");
}

TEST(DisparityNodelet, BadParametersOfTheStartAreSaid) {
  LogLines log;
  NodeletGraph graph("/bad_start", {{"image_transport", std::string("no_such")},
                                    {"approximate_sync", true},
                                    {"approximate_sync_tolerance", 1e300},
                                    {"queue_size", -5},
                                    {"watch_period", -1.0},
                                    {"diagnostic_period", std::string("often")}});
  EXPECT_NE(log.wait({"~image_transport", "no_such", "using raw"}), "");
  EXPECT_NE(log.wait({"~approximate_sync_tolerance", "using 0"}), "");
  EXPECT_NE(log.wait({"~queue_size = -5", "using 1"}), "");
  EXPECT_NE(log.wait({"~diagnostic_period", "no number"}), "");
  EXPECT_TRUE(graph.process(goodMessages()));
}

TEST(DisparityNodelet, ParametersOfAnotherTypeAreSaidAndReplaced) {
  LogLines log;
  NodeletGraph graph("/types", {{"queue_size", std::string("five")},
                                {"approximate_sync", 3.5},
                                {"nearest", std::string("0.5 m")},
                                {"left_mask", 7},
                                {"seeds_fixed_frame", true}});
  for (const char* name : {"queue_size", "approximate_sync", "nearest", "left_mask", "seeds_fixed_frame"}) {
    EXPECT_NE(log.wait({"~" + std::string(name) + " is no "}), "") << name;
  }
  EXPECT_TRUE(graph.process(goodMessages()));
}

TEST(DisparityNodelet, ANearestDistanceThatCannotBeIsSaidAndTheRangeStays) {
  for (const double nearest : {-1.0, 1e-9, std::nan("")}) {
    LogLines log;
    NodeletGraph graph("/nearest", {{"nearest", nearest}});
    EXPECT_TRUE(graph.process(goodMessages())) << nearest;
    EXPECT_NE(log.wait({"nearest distance"}), "") << nearest;
  }
}

/// A calibration in another unit, and what the range can see: once each, however many pairs come.
TEST(DisparityNodelet, TellsOnceWhatHoldsForTheCamera) {
  LogLines log;
  NodeletGraph graph("/unit");
  Messages messages = goodMessages();
  messages.right_info.P[3] = -20000.0;
  const auto disparity = graph.process(messages);
  ASSERT_TRUE(disparity);
  EXPECT_FLOAT_EQ(disparity->T, 100.0F);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(graph.process(messages));
  EXPECT_NE(log.wait({"/unit/right/camera_info", "P[3] = -20000", "100 m", "millimetres"}), "");
  const std::vector<std::string> lines = log.lines();
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                          [](const std::string& line) { return line.find("millimetres") != std::string::npos; }),
            1);
}

/// Nice levels of the threads of this process.
std::vector<int> niceLevels() {
  std::vector<int> levels;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    levels.push_back(getpriority(PRIO_PROCESS, static_cast<id_t>(std::stoi(task.path().filename()))));
  }
  return levels;
}

TEST(DisparityNodelet, ThreadsAndNiceLevelOfTheWorkersOnly) {
  NodeletGraph graph("/nice", {{"threads", 3}, {"nice", 7}});
  ASSERT_TRUE(graph.process(goodMessages()));
  const int own = getpriority(PRIO_PROCESS, 0);
  std::vector<int> levels = niceLevels();
  EXPECT_EQ(std::count(levels.begin(), levels.end(), 7), 3);
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), own);
  graph.edit([](auto& config) {
    ConfigTools::appendParameter(config, "threads", 5);
    ConfigTools::appendParameter(config, "nice", 9);
  });
  ASSERT_TRUE(graph.process(goodMessages()));
  levels = niceLevels();
  EXPECT_EQ(std::count(levels.begin(), levels.end(), 7), 0);
  EXPECT_EQ(std::count(levels.begin(), levels.end(), 9), 5);
}

TEST(DisparityNodelet, ApproximateSynchronisation) {
  NodeletGraph graph("/approximate", {{"approximate_sync", true}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  Messages messages = goodMessages();
  stereo_msgs::DisparityImageConstPtr received;
  for (int i = 0; i < 40 && !received; ++i) {
    messages.stamp(nextStamp());
    messages.right.header.stamp += ros::Duration(0.004);
    messages.right_info.header.stamp += ros::Duration(0.004);
    graph.camera().publish(messages);
    received = graph.disparity().wait([](const auto&) { return true; }, 0.2);
  }
  ASSERT_TRUE(received);
  const double offset_ms = std::fmod(received->header.stamp.toSec() * 1e3 + 0.5, 50.0);
  EXPECT_LT(offset_ms, 2.0) << "the stamp is the left image's";
}

TEST(DisparityNodelet, SaysWhyNothingComesOut) {
  LogLines log;
  NodeletGraph graph("/silent", {{"watch_period", 0.4}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  Messages messages = goodMessages();
  const auto send_apart = [&] {
    messages.stamp(nextStamp());
    messages.right.header.stamp += ros::Duration(0.007);
    graph.camera().publish(messages);
    return log.wait({"no synchronised pair", "/silent/right/image_rect", "7 ms", "~approximate_sync"}, 0.02) != "";
  };
  EXPECT_TRUE(waitUntil(send_apart, 10.0));
  EXPECT_NE(log.wait({"no synchronised pair", "/silent/left/image_rect", "sends nothing"}, 10.0), "");
}

TEST(DisparityNodelet, ABagThatLoops) {
  NodeletGraph graph("/loop");
  ASSERT_TRUE(graph.process(goodMessages()));
  Messages messages = goodMessages();
  // Leftovers that never find their partner would fill an exact synchroniser for ever.
  for (int i = 0; i < 20; ++i) {
    messages.stamp(nextStamp());
    messages.right.header.stamp += ros::Duration(0.001);
    graph.camera().publish(messages);
    ros::WallDuration(0.005).sleep();
  }
  graph.disparity().clear();
  stereo_msgs::DisparityImageConstPtr received;
  for (int i = 0; i < 40 && !received; ++i) {
    messages.stamp(ros::Time(10.0) + ros::Duration(0.05 * i));
    graph.camera().publish(messages);
    received = graph.disparity().wait([](const auto& d) { return d.header.stamp < ros::Time(100.0); }, 0.3);
  }
  EXPECT_TRUE(received);
}

TEST(DisparityNodelet, MaxRateLeavesOutAndCounts) {
  NodeletGraph graph("/rate", {{"max_rate", 5.0}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  Messages messages = goodMessages();
  std::vector<ros::Time> stamps;
  for (int i = 0; i < 20; ++i) {  // 20 Hz by the stamps
    messages.stamp(nextStamp());
    stamps.push_back(messages.left.header.stamp);
    graph.camera().publish(messages);
    ros::WallDuration(0.1).sleep();
  }
  EXPECT_TRUE(graph.disparity().wait([&](const auto& d) { return d.header.stamp == stamps[16]; }));
  EXPECT_LE(graph.disparity().count(), 5U);
}

TEST(DisparityNodelet, MaxAgeDropsOldPairs) {
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics(ros::NodeHandle(), "/diagnostics");
  NodeletGraph graph("/age", {{"max_age", 0.5}});
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  Messages messages = goodMessages();  // stamped long ago
  const auto counted = [](const diagnostic_msgs::DiagnosticArray& array) {
    for (const auto& status : array.status) {
      if (status.name.find("age/disparity_nodelet") == std::string::npos) continue;
      for (const auto& entry : status.values) {
        if (entry.key == "Pairs dropped (max_age)" && entry.value != "0") return true;
      }
    }
    return false;
  };
  messages.stamp(nextStamp());
  graph.camera().publish(messages);
  EXPECT_TRUE(diagnostics.wait(counted));
  EXPECT_EQ(graph.disparity().count(), 0U);
  messages.stamp(ros::Time::now());
  const auto received = [&] {
    messages.stamp(ros::Time::now());
    graph.camera().publish(messages);
    return graph.disparity().wait([](const auto&) { return true; }, 0.3) != nullptr;
  };
  EXPECT_TRUE(waitUntil(received));
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "disparity_nodelet_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
