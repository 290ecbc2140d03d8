// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a robot does to a node over a day, in short. FDP_STEREO_SOAK_FRAMES lengthens the soak (scripts/soak.sh).
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <thread>

#include <dynamic_reconfigure/config_tools.h>
#include <gtest/gtest.h>

#include "nodelet_graph.hpp"
#include "params_ros.hpp"

namespace fdp_stereo {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigTools;
using test::Camera;
using test::goodMessages;
using test::Inbox;
using test::Messages;
using test::nextStamp;
using test::NodeletGraph;
using test::waitUntil;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool kSanitized = false;
#endif

/// A line of /proc/self/status: kB or a count.
long processStatus(const std::string& key) {
  std::ifstream file("/proc/self/status");
  std::string word;
  long value = -1;
  while (file >> word) {
    if (word == key + ":") file >> value;
  }
  return value;
}

/// A camera that runs in a thread of its own.
class RunningCamera {
 public:
  RunningCamera(Camera& camera, double hz) : camera_(camera), period_(1.0 / hz), thread_([this] { run(); }) {}
  ~RunningCamera() {
    stop_ = true;
    thread_.join();
  }

 private:
  void run() {
    Messages messages = goodMessages();
    while (!stop_) {
      messages.stamp(nextStamp());
      camera_.publish(messages);
      ros::WallDuration(period_).sleep();
    }
  }
  Camera& camera_;
  double period_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Ends the test with a word where what it guards hangs.
class Watchdog {
 public:
  explicit Watchdog(std::chrono::seconds patience)
      : thread_([this, patience] {
          std::unique_lock<std::mutex> lock(mutex_);
          if (ended_.wait_for(lock, patience, [this] { return end_; })) return;
          std::cerr << "no end after " << patience.count() << " s: a deadlock\n";
          std::abort();
        }) {}
  ~Watchdog() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      end_ = true;
    }
    ended_.notify_all();
    thread_.join();
  }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

/// Repeats an action in a thread of its own.
class Repeated {
 public:
  explicit Repeated(std::function<void()> action)
      : thread_([this, action] {
          while (!stop_) action();
        }) {}
  ~Repeated() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST(LifeCycle, TwoHundredReloadsWhileImagesFlow) {
  NodeletGraph graph("/reload");
  ASSERT_TRUE(graph.process(goodMessages()));
  graph.unload();
  graph.load();
  const RunningCamera camera(graph.camera(), 100.0);
  ASSERT_TRUE(graph.process(goodMessages()));
  test::LogLines log;
  const long threads = processStatus("Threads");
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(graph.unload()) << i;
    ASSERT_TRUE(graph.load()) << i;
    if (i % 20 == 0) {
      ASSERT_TRUE(graph.process(goodMessages())) << i;
    }
  }
  ASSERT_TRUE(graph.process(goodMessages()));
  graph.edit([](Config& config) { ConfigTools::appendParameter(config, "disparity_range", 16); });
  EXPECT_TRUE(log.lines().empty()) << log.lines().front();
  EXPECT_LE(processStatus("Threads"), threads + 2) << "the connections may take one more for a moment";
}

TEST(LifeCycle, FourInstancesInOneProcess) {
  std::vector<std::unique_ptr<NodeletGraph>> graphs;
  for (const char* name : {"/one", "/two", "/three", "/four"}) graphs.push_back(std::make_unique<NodeletGraph>(name));
  graphs[1]->edit([](Config& config) { ConfigTools::appendParameter(config, "disparity_range", 16); });
  for (auto& graph : graphs) {
    const auto disparity = graph->process(goodMessages());
    ASSERT_TRUE(disparity);
    EXPECT_FLOAT_EQ(disparity->max_disparity, graph == graphs[1] ? 15.0F : 31.0F);
  }
}

TEST(LifeCycle, SubscriberChurn) {
  NodeletGraph graph("/churn");
  const RunningCamera camera(graph.camera(), 50.0);
  for (int i = 0; i < 30; ++i) {
    graph.disparity().close();
    ros::WallDuration(0.05).sleep();
    graph.disparity().open();
    ros::WallDuration(0.05).sleep();
  }
  EXPECT_TRUE(graph.process(goodMessages()));
  graph.disparity().close();
  EXPECT_TRUE(graph.camera().waitForSubscribers(0));
}

/// Images, edits, subscribers that come and go, diagnostics and reloads at the same time: no deadlock.
TEST(LifeCycle, EverythingAtOnce) {
  const Watchdog watchdog(std::chrono::seconds(300));
  NodeletGraph graph("/all", {{"diagnostic_period", 0.02}, {"watch_period", 0.02}});
  ASSERT_TRUE(graph.process(goodMessages()));
  {
    const RunningCamera camera(graph.camera(), 100.0);
    const Repeated churn([&] {
      const Inbox<sensor_msgs::Image> depth(graph.node(), "depth");
      graph.disparity().close();
      ros::WallDuration(0.03).sleep();
      graph.disparity().open();
      ros::WallDuration(0.03).sleep();
    });
    const Repeated edits([&, i = 0]() mutable {
      dynamic_reconfigure::Reconfigure call;  // fails while the nodelet is unloaded
      ConfigTools::appendParameter(call.request.config, "disparity_range", 16 + ++i % 32);
      ros::service::call(graph.nodeletName() + "/set_parameters", call);
      ros::WallDuration(0.01).sleep();
    });
    for (int i = 0; i < 30; ++i) {
      ros::WallDuration(0.05).sleep();
      ASSERT_TRUE(graph.unload()) << i;
      ASSERT_TRUE(graph.load()) << i;
    }
  }
  EXPECT_TRUE(graph.process(goodMessages()));
}

/// One frame = one set of parameters: the published range is never half of one edit and half of another.
TEST(LifeCycle, EditsNeverTear) {
  NodeletGraph graph("/tear");
  const RunningCamera camera(graph.camera(), 100.0);
  // At least 100 edits, and on a busy machine as many more as it takes for some frames to come between them.
  for (int i = 0; i < 100 || (i < 10000 && graph.disparity().count() <= 5); ++i) {
    graph.edit([&](Config& config) {
      ConfigTools::appendParameter(config, "min_disparity", i % 2 == 0 ? 2 : 0);
      ConfigTools::appendParameter(config, "disparity_range", i % 2 == 0 ? 20 : 32);
    });
  }
  const auto torn = [](const stereo_msgs::DisparityImage& d) {
    const bool even = d.min_disparity == 2.0F && d.max_disparity == 21.0F;
    const bool odd = d.min_disparity == 0.0F && d.max_disparity == 31.0F;
    return !even && !odd;
  };
  EXPECT_TRUE(graph.process(goodMessages()));
  EXPECT_GT(graph.disparity().count(), 5U);
  EXPECT_FALSE(graph.disparity().wait(torn, 0.0));
}

/// Sets one parameter by its ROS name, whatever its type is.
void append(Config& config, const ParamRef& ref, double value) {
  if (std::holds_alternative<bool*>(ref.value)) {
    ConfigTools::appendParameter(config, ref.ros_name, value != 0.0);
  } else if (std::holds_alternative<double*>(ref.value)) {
    ConfigTools::appendParameter(config, ref.ros_name, value);
  } else {
    ConfigTools::appendParameter(config, ref.ros_name, static_cast<int>(value));
  }
}

TEST(LifeCycle, EveryParameterThroughItsRange) {
  NodeletGraph graph("/sweep");
  const RunningCamera camera(graph.camera(), 50.0);
  NodeSettings settings;
  settings.pipeline = loadPreset(kDefaultPreset);
  settings.pipeline.search.count = 32;
  Config initial;
  toConfig(settings, initial);
  for (const ParamRef& ref : liveParamList(settings)) {
    if (ref.ros_name == "nice") continue;  // cannot be taken back without privileges
    for (const double value : {ref.min, ref.max}) {
      graph.edit([&](Config& config) { append(config, ref, value); });
      ros::WallDuration(0.03).sleep();
    }
    graph.edit([&](Config& config) { config = initial; });
  }
  EXPECT_TRUE(graph.process(goodMessages(), 600.0)) << "a frame with the costliest values may take long";
}

TEST(LifeCycle, SoakDoesNotGrow) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer keeps what was freed; it looks for leaks itself";
  const char* wanted = std::getenv("FDP_STEREO_SOAK_FRAMES");
  const int frames = wanted != nullptr ? std::atoi(wanted) : 700;
  constexpr int kWarmUp = 500;
  NodeletGraph graph("/soak");
  const Inbox<sensor_msgs::Image> depth(graph.node(), "depth");
  const Inbox<sensor_msgs::Image> confidence(graph.node(), "confidence");
  const Inbox<sensor_msgs::Image> seeds(graph.node(), "seeds/image");
  ASSERT_TRUE(graph.camera().waitForSubscribers(4));
  Messages messages = goodMessages(96, 64);
  long before = 0;
  for (int i = 0; i < frames; ++i) {
    messages.stamp(nextStamp());
    const ros::Time stamp = messages.left.header.stamp;
    graph.camera().publish(messages);
    ASSERT_TRUE(graph.disparity().wait([&](const auto& d) { return d.header.stamp == stamp; })) << "frame " << i;
    graph.disparity().clear();
    if (i == kWarmUp) before = processStatus("VmRSS");
  }
  const long growth_kb = processStatus("VmRSS") - before;
  RecordProperty("rss_growth_kb", static_cast<int>(growth_kb));
  std::cout << frames << " frames, RSS " << before << " kB after frame " << kWarmUp << ", growth " << growth_kb
            << " kB\n";
  EXPECT_LT(growth_kb, 2048);
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "life_cycle_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
