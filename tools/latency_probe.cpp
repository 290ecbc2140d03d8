// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A synthetic stereo camera that measures the node it feeds: the time of live edits, and the age of the disparities
// against the time that the node says it needed.
// Private parameters: rate (Hz), edits, seconds, preset (for the printout).
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <map>
#include <mutex>
#include <thread>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <dynamic_reconfigure/config_tools.h>
#include <ros/ros.h>
#include <stereo_msgs/DisparityImage.h>
#include <opencv2/imgproc.hpp>

#include "conversions.hpp"

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

class Probe {
 public:
  explicit Probe(double rate_hz) : rate_hz_(rate_hz) {
    ros::NodeHandle node;
    left_ = node.advertise<sensor_msgs::Image>("left/image_rect", 2);
    right_ = node.advertise<sensor_msgs::Image>("right/image_rect", 2);
    left_info_ = node.advertise<sensor_msgs::CameraInfo>("left/camera_info", 2);
    right_info_ = node.advertise<sensor_msgs::CameraInfo>("right/camera_info", 2);
    disparity_ = node.subscribe("disparity", 10, &Probe::onDisparity, this);
    diagnostics_ = node.subscribe("/diagnostics", 10, &Probe::onDiagnostics, this);
    makePair();
  }

  bool connected() const { return left_.getNumSubscribers() > 0 && right_info_.getNumSubscribers() > 0; }

  void publish() {
    const ros::Time stamp = ros::Time::now();
    for (auto* header : {&left_image_.header, &right_image_.header, &left_camera_.header, &right_camera_.header}) {
      header->stamp = stamp;
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      sent_[stamp] = Clock::now();
      if (sent_.size() > 2000) sent_.erase(sent_.begin());
    }
    left_info_.publish(left_camera_);
    right_info_.publish(right_camera_);
    left_.publish(left_image_);
    right_.publish(right_image_);
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
  void makePair() {
    constexpr int kWidth = 320;
    constexpr int kHeight = 240;
    constexpr int kDisparity = 20;
    cv::Mat texture(kHeight, kWidth + kDisparity, CV_8UC1);
    cv::RNG rng(1);
    rng.fill(texture, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(texture, texture, cv::Size(), 1.5);
    cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
    std_msgs::Header header;
    header.frame_id = "camera";
    left_image_ = *fdp_stereo::toImageMessage(texture.colRange(0, kWidth), header);
    right_image_ = *fdp_stereo::toImageMessage(texture.colRange(kDisparity, kDisparity + kWidth), header);
    left_camera_.header = header;
    left_camera_.width = kWidth;
    left_camera_.height = kHeight;
    left_camera_.P = {300.0, 0.0, kWidth / 2.0, 0.0, 0.0, 300.0, kHeight / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    right_camera_ = left_camera_;
    right_camera_.P[3] = -30.0;
  }

  void onDisparity(const stereo_msgs::DisparityImageConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto sent = sent_.find(message->header.stamp);
    if (sent != sent_.end()) ages_ms_.push_back(millisecondsSince(sent->second));
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

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "latency_probe");
  ros::NodeHandle private_node("~");
  const double rate_hz = std::clamp(private_node.param("rate", 30.0), 0.1, 1000.0);
  const int edits = private_node.param("edits", 0);
  std::printf("preset %s, input %.0f Hz\n", private_node.param<std::string>("preset", "?").c_str(), rate_hz);
  Probe probe(rate_hz);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  while (ros::ok() && !probe.connected()) ros::WallDuration(0.01).sleep();

  std::atomic<bool> stop{false};
  std::thread camera([&] {
    for (ros::WallRate rate(rate_hz); ros::ok() && !stop; rate.sleep()) probe.publish();
  });
  ros::WallDuration(1.0).sleep();
  const std::vector<double> times_ms = timeEdits(edits);
  if (edits == 0) ros::WallDuration(private_node.param("seconds", 10.0)).sleep();
  stop = true;
  camera.join();
  spinner.stop();
  if (!times_ms.empty()) {
    std::printf("edit: %zu edits, median %.1f ms, slowest %.1f ms\n", times_ms.size(), percentile(times_ms, 0.5),
                percentile(times_ms, 1.0));
  }
  probe.report();
  return 0;
}
