// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Listens to a running graph until its images end, then writes a picture and a summary of what came out.
// Private parameters: output (folder), color (which left image), idle_s (silence that means the end), wait_s (for the
// first image). Exit code 0 only if disparity arrived.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <opencv2/imgproc.hpp>

#include "command_line.hpp"
#include "conversions.hpp"
#include "fdp_stereo/io.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point time) { return std::chrono::duration<double>(Clock::now() - time).count(); }

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Report {
 public:
  explicit Report(const std::string& image_topic) {
    ros::NodeHandle node;
    image_ = node.subscribe(image_topic, 100, &Report::onImage, this);
    disparity_ = node.subscribe("disparity", 100, &Report::onDisparity, this);
    points_ = node.subscribe("points2", 100, &Report::onPoints, this);
  }

  bool started() const { return images_ > 0; }
  double idleSeconds() const { return secondsSince(last_message_); }
  bool ok() const { return !latencies_ms_.empty(); }

  std::string summary() const {
    const double seconds = std::chrono::duration<double>(last_disparity_ - first_disparity_).count();
    const double hz = latencies_ms_.size() > 1 ? static_cast<double>(latencies_ms_.size() - 1) / seconds : 0.0;
    const double slowest = ok() ? *std::max_element(latencies_ms_.begin(), latencies_ms_.end()) : 0.0;
    std::ostringstream text;
    text << std::fixed << std::setprecision(1);
    text << "frames in:            " << images_ << "\n"
         << "disparity images out: " << latencies_ms_.size() << "\n"
         << "point clouds out:     " << clouds_ << "\n"
         << "rate of disparity:    " << hz << " Hz\n"
         << "latency, median:      " << median(latencies_ms_) << " ms\n"
         << "latency, slowest:     " << slowest << " ms\n"
         << "valid pixels:         " << 100.0 * median(valid_shares_) << " %\n"
         << "points of a cloud:    " << points_of_last_ << "\n";
    return text.str();
  }

  /// The left image beside the coloured disparity of the newest pair of which both arrived.
  void writePicture(const std::string& path) const {
    if (picture_image_ && picture_disparity_) fdp_stereo::writeImage(path, draw());
  }

 private:
  void onImage(const sensor_msgs::ImageConstPtr& message) {
    ++images_;
    last_message_ = Clock::now();
    waiting_[message->header.stamp] = {message, last_message_};
  }

  void onDisparity(const stereo_msgs::DisparityImageConstPtr& message) {
    last_message_ = last_disparity_ = Clock::now();
    if (latencies_ms_.empty()) first_disparity_ = last_disparity_;
    const auto image = waiting_.find(message->header.stamp);
    const double latency = image == waiting_.end() ? 0.0 : secondsSince(image->second.arrival) * 1e3;
    latencies_ms_.push_back(latency);
    const cv::Mat map = fdp_stereo::fromDisparityMessage(*message, {}, "disparity");
    valid_shares_.push_back(static_cast<double>(cv::countNonZero(map == map)) / static_cast<double>(map.total()));
    if (image == waiting_.end()) return;
    picture_image_ = image->second.message;
    picture_disparity_ = message;
    waiting_.erase(waiting_.begin(), std::next(image));
  }

  void onPoints(const sensor_msgs::PointCloud2ConstPtr& message) {
    last_message_ = Clock::now();
    ++clouds_;
    points_of_last_ = static_cast<std::size_t>(message->width) * message->height;
  }

  cv::Mat draw() const {
    const auto& d = *picture_disparity_;
    const cv::Mat map = fdp_stereo::fromDisparityMessage(d, {}, "disparity");
    const int min = static_cast<int>(d.min_disparity);
    const cv::Mat colours = fdp_stereo::colorize(map, {min, static_cast<int>(d.max_disparity) - min + 1});
    cv::Mat left = fdp_stereo::decodeImage(*picture_image_, "left image");
    if (left.depth() != CV_8U) left.convertTo(left, CV_8U, 1.0 / 256.0);
    if (left.channels() == 1) cv::cvtColor(left, left, cv::COLOR_GRAY2BGR);
    cv::Mat both;
    cv::hconcat(left, colours, both);
    return both;
  }

  struct Waiting {
    sensor_msgs::ImageConstPtr message;
    Clock::time_point arrival;
  };

  ros::Subscriber image_, disparity_, points_;
  std::map<ros::Time, Waiting> waiting_;
  sensor_msgs::ImageConstPtr picture_image_;
  stereo_msgs::DisparityImageConstPtr picture_disparity_;
  Clock::time_point last_message_ = Clock::now();
  Clock::time_point first_disparity_, last_disparity_;
  std::vector<double> latencies_ms_, valid_shares_;
  std::size_t images_ = 0, clouds_ = 0, points_of_last_ = 0;
};

void waitForEnd(const Report& report, double wait_s, double idle_s) {
  while (ros::ok() && report.idleSeconds() < (report.started() ? idle_s : wait_s)) {
    ros::spinOnce();
    ros::WallDuration(0.01).sleep();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--version") {
    std::cout << fdp_stereo::versionText("demo_report") << '\n';
    return 0;
  }
  ros::init(argc, argv, "demo_report");
  ros::NodeHandle private_node("~");
  const std::filesystem::path output = private_node.param<std::string>("output", ".");
  Report report(private_node.param("color", true) ? "left/image_rect_color" : "left/image_rect");
  waitForEnd(report, private_node.param("wait_s", 60.0), private_node.param("idle_s", 5.0));
  try {
    std::filesystem::create_directories(output);
    report.writePicture((output / "disparity.png").string());
    std::ofstream(output / "summary.txt") << report.summary();
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  std::cout << report.summary() << std::flush;
  return report.ok() ? 0 : 1;
}
