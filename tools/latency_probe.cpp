// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A synthetic stereo camera that measures the node it feeds: the time of live edits, the age of the disparities against
// the time that the node says it needed, the time from a pair to its disparity against the core's alone, that from raw
// images rectified by the node against image_proc's, and what a deadline does beside other work.
// Private parameters: rate (Hz), edits, seconds, width, height, preset and range (of the core beside the node),
// pairs (compared one by one with the core instead), inside (load the nodelet into this process, as a manager does),
// rectify (compare pairs of raw images), deadline (measure that of the node; ms).
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <functional>
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
#include <opencv2/calib3d.hpp>
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
  SyntheticPair(cv::Size size, unsigned texture) : left(size, CV_8UC1) {
    cv::RNG rng(texture);
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

/// Shown in turns: what stays the same would not be matched again.
using Scenes = std::array<SyntheticPair, 2>;

/// What a camera with the distortion of `info` sees where a rectified one sees `image`.
cv::Mat distorted(const cv::Mat& image, const sensor_msgs::CameraInfo& info) {
  std::vector<cv::Point2f> places;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) places.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  const cv::Matx33d camera(info.K.data());
  std::vector<cv::Point2f> seen;
  cv::undistortPoints(places, seen, camera, info.D, cv::noArray(), camera);
  cv::Mat raw;
  cv::remap(image, raw, cv::Mat(seen).reshape(2, image.rows), cv::noArray(), cv::INTER_LINEAR);
  return raw;
}

class Probe {
 public:
  /// image: name of the topics. Raw images are distorted.
  Probe(const ros::NodeHandle& base, const std::string& image, double rate_hz, const Scenes& scenes)
      : rate_hz_(rate_hz) {
    ros::NodeHandle node(base);
    left_ = node.advertise<sensor_msgs::Image>("left/" + image, 2);
    right_ = node.advertise<sensor_msgs::Image>("right/" + image, 2);
    left_info_ = node.advertise<sensor_msgs::CameraInfo>("left/camera_info", 2);
    right_info_ = node.advertise<sensor_msgs::CameraInfo>("right/camera_info", 2);
    disparity_ = node.subscribe("disparity", 10, &Probe::onDisparity, this, ros::TransportHints().tcpNoDelay());
    diagnostics_ = node.subscribe("/diagnostics", 10, &Probe::onDiagnostics, this);
    makeMessages(scenes, image == "image_raw");
  }

  bool connected() const {
    return left_.getNumSubscribers() > 0 && right_.getNumSubscribers() > 0 && left_info_.getNumSubscribers() > 0 &&
           right_info_.getNumSubscribers() > 0;
  }

  /// Messages of their own for each pair, as a driver makes them: inside one process they are handed over uncopied.
  ros::Time publish() {
    const auto left_info = boost::make_shared<sensor_msgs::CameraInfo>(left_camera_);
    const auto right_info = boost::make_shared<sensor_msgs::CameraInfo>(right_camera_);
    scene_ = 1 - scene_;
    const auto left = boost::make_shared<sensor_msgs::Image>(left_images_[scene_]);
    const auto right = boost::make_shared<sensor_msgs::Image>(right_images_[scene_]);
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

  /// What the node did since the last call.
  void reportDeadline(const char* phase, double deadline_ms) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const double processing = percentile(processing_ms_, 0.95);
    std::printf("deadline %.0f ms, %s: %zu pairs, processing median %.1f ms, 95 %% %.1f ms; last scale %.2f: %s\n",
                deadline_ms, phase, processing_ms_.size(), percentile(processing_ms_, 0.5), processing, scale_,
                processing <= deadline_ms ? "held" : "NOT held");
    processing_ms_.clear();
  }

 private:
  void makeMessages(const Scenes& scenes, bool raw) {
    left_camera_.header.frame_id = "camera";
    const cv::Size size = scenes[0].left.size();
    left_camera_.width = static_cast<std::uint32_t>(size.width);
    left_camera_.height = static_cast<std::uint32_t>(size.height);
    left_camera_.distortion_model = "plumb_bob";
    left_camera_.D.assign(5, 0.0);
    if (raw) left_camera_.D = {-0.25, 0.06, 0.0005, -0.0003, 0.0};
    left_camera_.K = {0.6 * size.width, 0.0, size.width / 2.0, 0.0, 0.6 * size.width, size.height / 2.0, 0.0, 0.0, 1.0};
    left_camera_.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    for (int i = 0; i < 3; ++i) std::copy_n(left_camera_.K.data() + 3 * i, 3, left_camera_.P.data() + 4 * i);
    right_camera_ = left_camera_;
    right_camera_.P[3] = -0.1 * right_camera_.P[0];
    const auto message = [&](const cv::Mat& image) {
      return *fdp_stereo::toImageMessage(raw ? distorted(image, left_camera_) : image, left_camera_.header);
    };
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      left_images_[i] = message(scenes[i].left);
      right_images_[i] = message(scenes[i].right);
    }
  }

  void onDisparity(const stereo_msgs::DisparityImageConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto sent = sent_.find(message->header.stamp);
    if (sent == sent_.end()) return;
    ages_ms_.push_back(millisecondsSince(sent->second));
    newest_ = message->header.stamp;
    arrived_.notify_all();
  }

  /// The newest pair of each message, once.
  void onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& status : message->status) {
      std::map<std::string, std::string> values;
      for (const auto& entry : status.values) values[entry.key] = entry.value;
      const std::string& processed = values["Pairs processed"];
      if (processed.empty() || processed == "0" || processed == processed_) continue;
      processed_ = processed;
      processing_ms_.push_back(std::stod(values["Processing (ms)"]));
      scale_ = std::stod(values["Scale of the images matched"]);
    }
  }

  double rate_hz_;
  ros::Publisher left_, right_, left_info_, right_info_;
  ros::Subscriber disparity_, diagnostics_;
  std::array<sensor_msgs::Image, 2> left_images_, right_images_;
  std::size_t scene_ = 0;
  sensor_msgs::CameraInfo left_camera_, right_camera_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  ros::Time newest_;
  std::map<ros::Time, Clock::time_point> sent_;
  std::vector<double> ages_ms_, processing_ms_;
  std::string processed_;  ///< pairs, as the node says
  double scale_ = 1.0;
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

constexpr int kWarmUp = 3;  // pairs

void waitFor(const std::function<bool()>& condition) {
  while (ros::ok() && !condition()) ros::WallDuration(0.01).sleep();
}

/// The same pair through the node and through the core, in turns, so that both meet the same machine.
void compareWithCore(Probe& probe, const SyntheticPair& pair, const std::string& preset, int range, int pairs) {
  fdp_stereo::PipelineParams params = fdp_stereo::loadPreset(preset);
  params.search = {0, range};
  fdp_stereo::Pipeline pipeline(params);
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

/// Raw pairs to a node that rectifies them, and to one behind image_proc, in turns.
void compareRectification(const Scenes& scenes, int pairs) {
  Probe internal(ros::NodeHandle("internal"), "image_raw", 1.0, scenes);
  Probe image_proc(ros::NodeHandle("image_proc"), "image_raw", 1.0, scenes);
  waitFor([&] { return internal.connected() && image_proc.connected(); });
  std::vector<double> internal_ms;
  std::vector<double> image_proc_ms;
  std::vector<double> ratios;
  for (int i = 0; i < kWarmUp + pairs && ros::ok(); ++i) {
    const double one_ms = internal.timeOnePair();
    const double two_ms = image_proc.timeOnePair();
    if (i < kWarmUp || one_ms < 0.0 || two_ms < 0.0) continue;
    internal_ms.push_back(one_ms);
    image_proc_ms.push_back(two_ms);
    ratios.push_back(one_ms / two_ms);
  }
  std::printf(
      "raw pair to disparity: %zu pairs, rectified in the node median %.1f ms, by image_proc %.1f ms; ratio %.3f\n",
      ratios.size(), percentile(internal_ms, 0.5), percentile(image_proc_ms, 0.5), percentile(ratios, 0.5));
}

/// Beside nothing, beside work for half of the cores, and beside nothing again.
void measureDeadline(Probe& probe, double rate_hz, double deadline_ms, double seconds) {
  for (const char* phase : {"alone", "beside other work", "alone again"}) {
    std::atomic<bool> stop{phase != std::string("beside other work")};
    std::vector<std::thread> others;
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency() / 2); ++i) {
      others.emplace_back([&stop] {
        for (volatile unsigned turns = 0; !stop; turns = turns + 1) {
        }
      });
    }
    ros::WallRate rate(rate_hz);
    for (int i = 0; i < seconds * rate_hz && ros::ok(); ++i, rate.sleep()) probe.publish();
    stop = true;
    for (std::thread& other : others) other.join();
    probe.reportDeadline(phase, deadline_ms);
  }
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
  const double deadline_ms = private_node.param("deadline", 0.0);
  const double seconds = private_node.param("seconds", 10.0);
  const cv::Size size(private_node.param("width", 320), private_node.param("height", 240));
  const Scenes scenes{SyntheticPair(size, 1), SyntheticPair(size, 2)};
  ros::AsyncSpinner spinner(2);
  spinner.start();
  if (private_node.param("rectify", false)) {
    compareRectification(scenes, pairs);
    return 0;
  }
  std::printf("preset %s, %s%s\n", preset.c_str(), inside ? "in one process" : "over TCP",
              pairs > 0 ? "" : (", input " + std::to_string(static_cast<int>(rate_hz)) + " Hz").c_str());
  Probe probe(ros::NodeHandle(), "image_rect", rate_hz, scenes);
  nodelet::Loader loader(false);
  if (inside && !loader.load(ros::names::resolve("disparity"), "fdp_stereo/disparity", {}, {})) return 1;
  waitFor([&] { return probe.connected(); });

  if (deadline_ms > 0.0) {
    measureDeadline(probe, rate_hz, deadline_ms, seconds);
  } else if (pairs > 0) {
    compareWithCore(probe, scenes[0], preset, private_node.param("range", 64), pairs);
  } else {
    measureStream(probe, rate_hz, private_node.param("edits", 0), seconds);
    spinner.stop();
    probe.report();
  }
  return 0;
}
