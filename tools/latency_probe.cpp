// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A synthetic stereo camera that measures the node it feeds: the time of live edits, the age of the disparities against
// the time that the node says it needed, and the time from a pair to its disparity against the core's alone.
// Private parameters: rate (Hz), edits, seconds, width, height, preset and range (of the core beside the node),
// pairs (compared one by one with the core instead), inside (load the nodelet into this process, as a manager does).
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <dynamic_reconfigure/config_tools.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <stereo_msgs/DisparityImage.h>
#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "command_line.hpp"
#include "conversions.hpp"
#include "fdp_stereo/pipeline.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Nearest rank; 0 for no values.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

/// A slanted, textured surface seen by both cameras.
struct SyntheticPair {
  explicit SyntheticPair(cv::Size size) : left(size, CV_8UC1) {
    cv::RNG rng(1);
    right.create(size, CV_8UC1);
    rng.fill(right, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(right, right, cv::Size(), 1.5);
    cv::normalize(right, right, 0, 255, cv::NORM_MINMAX);
    const float slope = 20.0F / static_cast<float>(size.height);
    cv::Mat from_x(size, CV_32FC1);
    cv::Mat from_y(size, CV_32FC1);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        from_x.at<float>(y, x) = static_cast<float>(x) - 5.0F - slope * static_cast<float>(y);
        from_y.at<float>(y, x) = static_cast<float>(y);
      }
    }
    cv::remap(right, left, from_x, from_y, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  }
  cv::Mat left;
  cv::Mat right;
};

class Probe {
 public:
  Probe(double rate_hz, const SyntheticPair& pair) : rate_hz_(rate_hz) {
    ros::NodeHandle node;
    left_ = node.advertise<sensor_msgs::Image>("left/image_rect", 2);
    right_ = node.advertise<sensor_msgs::Image>("right/image_rect", 2);
    left_info_ = node.advertise<sensor_msgs::CameraInfo>("left/camera_info", 2);
    right_info_ = node.advertise<sensor_msgs::CameraInfo>("right/camera_info", 2);
    disparity_ = node.subscribe("disparity", 10, &Probe::onDisparity, this, ros::TransportHints().tcpNoDelay());
    diagnostics_ = node.subscribe("/diagnostics", 10, &Probe::onDiagnostics, this);
    makeMessages(pair);
  }

  bool connected() const {
    return left_.getNumSubscribers() > 0 && right_.getNumSubscribers() > 0 && left_info_.getNumSubscribers() > 0 &&
           right_info_.getNumSubscribers() > 0;
  }

  /// Messages of their own for each pair, as a driver makes them: inside one process they are handed over uncopied.
  ros::Time publish() {
    const auto left_info = boost::make_shared<sensor_msgs::CameraInfo>(left_camera_);
    const auto right_info = boost::make_shared<sensor_msgs::CameraInfo>(right_camera_);
    const auto left = boost::make_shared<sensor_msgs::Image>(left_image_);
    const auto right = boost::make_shared<sensor_msgs::Image>(right_image_);
    const ros::Time stamp = ros::Time::now();
    for (auto* header : {&left->header, &right->header, &left_info->header, &right_info->header}) {
      header->stamp = stamp;
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      sent_[stamp] = Clock::now();
      if (sent_.size() > 2000) sent_.erase(sent_.begin());
    }
    left_info_.publish(left_info);
    right_info_.publish(right_info);
    left_.publish(left);
    right_.publish(right);
    return stamp;
  }

  /// Publishes one pair; ms until its disparity is here, < 0 where none comes.
  double timeOnePair() {
    const ros::Time stamp = publish();
    std::unique_lock<std::mutex> lock(mutex_);
    const bool came = arrived_.wait_for(lock, std::chrono::seconds(20), [&] { return newest_ == stamp; });
    return came ? ages_ms_.back() : -1.0;
  }

  void report() const {
    if (ages_ms_.empty()) {
      std::printf("output: no pair in this time\n");
      return;
    }
    const double age = percentile(ages_ms_, 0.95);
    const double processing = percentile(processing_ms_, 0.95);
    const double bound = processing + 1e3 / rate_hz_ + 10.0;
    std::printf("output: %zu pairs, age median %.1f ms, 95 %% %.1f ms; processing 95 %% %.1f ms; bound %.1f ms: %s\n",
                ages_ms_.size(), percentile(ages_ms_, 0.5), age, processing, bound, age <= bound ? "held" : "NOT held");
  }

 private:
  void makeMessages(const SyntheticPair& pair) {
    std_msgs::Header header;
    header.frame_id = "camera";
    left_image_ = *fdp_stereo::toImageMessage(pair.left, header);
    right_image_ = *fdp_stereo::toImageMessage(pair.right, header);
    left_camera_.header = header;
    left_camera_.width = left_image_.width;
    left_camera_.height = left_image_.height;
    left_camera_.P = {300.0, 0.0, pair.left.cols / 2.0, 0.0, 0.0, 300.0, pair.left.rows / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    right_camera_ = left_camera_;
    right_camera_.P[3] = -30.0;
  }

  void onDisparity(const stereo_msgs::DisparityImageConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto sent = sent_.find(message->header.stamp);
    if (sent == sent_.end()) return;
    ages_ms_.push_back(millisecondsSince(sent->second));
    newest_ = message->header.stamp;
    arrived_.notify_all();
  }

  void onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& status : message->status) {
      for (const auto& entry : status.values) {
        if (entry.key == "Processing (ms)" && std::stod(entry.value) > 0.0) {
          processing_ms_.push_back(std::stod(entry.value));
        }
      }
    }
  }

  double rate_hz_;
  ros::Publisher left_, right_, left_info_, right_info_;
  ros::Subscriber disparity_, diagnostics_;
  sensor_msgs::Image left_image_, right_image_;
  sensor_msgs::CameraInfo left_camera_, right_camera_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  ros::Time newest_;
  std::map<ros::Time, Clock::time_point> sent_;
  std::vector<double> ages_ms_, processing_ms_;
};

/// Edits one parameter to and fro, 10 a second, as a person with a slider does.
std::vector<double> timeEdits(int count) {
  ros::NodeHandle node;
  auto client = node.serviceClient<dynamic_reconfigure::Reconfigure>("disparity/set_parameters", true);
  client.waitForExistence(ros::Duration(20.0));
  std::vector<double> times_ms;
  for (int i = 0; i < count && ros::ok(); ++i) {
    dynamic_reconfigure::Reconfigure call;
    dynamic_reconfigure::ConfigTools::appendParameter(call.request.config, "speckle_size", 10 + i % 2);
    const auto start = Clock::now();
    if (!client.call(call)) break;
    times_ms.push_back(millisecondsSince(start));
    ros::WallDuration(0.1).sleep();
  }
  return times_ms;
}

/// The same pair through the node and through the core, in turns, so that both meet the same machine.
void compareWithCore(Probe& probe, const SyntheticPair& pair, const std::string& preset, int range, int pairs) {
  fdp_stereo::PipelineParams params = fdp_stereo::loadPreset(preset);
  params.search = {0, range};
  fdp_stereo::Pipeline pipeline(params);
  constexpr int kWarmUp = 3;
  std::vector<double> node_ms;
  std::vector<double> core_ms;
  for (int i = 0; i < kWarmUp + pairs && ros::ok(); ++i) {
    const double through_node = probe.timeOnePair();
    const auto start = Clock::now();
    pipeline.run(pair.left, pair.right);
    if (i < kWarmUp || through_node < 0.0) continue;
    node_ms.push_back(through_node);
    core_ms.push_back(millisecondsSince(start));
  }
  const double node = percentile(node_ms, 0.5);
  const double core = percentile(core_ms, 0.5);
  std::printf(
      "pair to disparity: %zu pairs of %d x %d px, range %d, median %.1f ms; the core alone %.1f ms; ratio %.2f\n",
      node_ms.size(), pair.left.cols, pair.left.rows, range, node, core, node / core);
}

/// Feeds the node at its rate meanwhile.
void measureStream(Probe& probe, double rate_hz, int edits, double seconds) {
  std::atomic<bool> stop{false};
  std::thread camera([&] {
    for (ros::WallRate rate(rate_hz); ros::ok() && !stop; rate.sleep()) probe.publish();
  });
  ros::WallDuration(1.0).sleep();
  const std::vector<double> times_ms = timeEdits(edits);
  if (edits == 0) ros::WallDuration(seconds).sleep();
  stop = true;
  camera.join();
  if (!times_ms.empty()) {
    std::printf("edit: %zu edits, median %.1f ms, slowest %.1f ms\n", times_ms.size(), percentile(times_ms, 0.5),
                percentile(times_ms, 1.0));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--version") {
    std::cout << fdp_stereo::versionText("latency_probe") << '\n';
    return 0;
  }
  ros::init(argc, argv, "latency_probe");
  ros::NodeHandle private_node("~");
  const double rate_hz = std::clamp(private_node.param("rate", 30.0), 0.1, 1000.0);
  const int pairs = private_node.param("pairs", 0);
  const bool inside = private_node.param("inside", false);
  const std::string preset = private_node.param<std::string>("preset", "fast");
  const SyntheticPair pair(cv::Size(private_node.param("width", 320), private_node.param("height", 240)));
  std::printf("preset %s, %s%s\n", preset.c_str(), inside ? "in one process" : "over TCP",
              pairs > 0 ? "" : (", input " + std::to_string(static_cast<int>(rate_hz)) + " Hz").c_str());
  Probe probe(rate_hz, pair);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  nodelet::Loader loader(false);
  if (inside && !loader.load(ros::names::resolve("disparity"), "fdp_stereo/disparity", {}, {})) return 1;
  while (ros::ok() && !probe.connected()) ros::WallDuration(0.01).sleep();

  if (pairs > 0) {
    compareWithCore(probe, pair, preset, private_node.param("range", 64), pairs);
  } else {
    measureStream(probe, rate_hz, private_node.param("edits", 0), private_node.param("seconds", 10.0));
    spinner.stop();
    probe.report();
  }
  return 0;
}
