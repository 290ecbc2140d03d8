// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <stereo_msgs/DisparityImage.h>

#include "messages.hpp"

/// The nodelet inside the test process, and a stereo camera that it listens to: what kills a manager kills the test.
namespace fdp_stereo::test {

inline bool waitUntil(const std::function<bool()>& condition, double seconds = 60.0) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    ros::WallDuration(0.002).sleep();
  }
  return true;
}

/// Keeps what a topic brings.
template <typename Message>
class Inbox {
 public:
  using Ptr = boost::shared_ptr<const Message>;
  Inbox(ros::NodeHandle node, const std::string& topic) : node_(node), topic_(topic) { open(); }
  void open() {
    subscriber_ = node_.subscribe<Message>(topic_, 1000, [this](const Ptr& m) { add(m); });
  }
  void close() { subscriber_.shutdown(); }
  std::uint32_t publishers() const { return subscriber_.getNumPublishers(); }

  /// The first message that fits, null after the time.
  Ptr wait(const std::function<bool(const Message&)>& fits, double seconds = 60.0) {
    Ptr found;
    waitUntil(
        [&] {
          const std::lock_guard<std::mutex> lock(mutex_);
          for (const Ptr& message : messages_) {
            if (!found && fits(*message)) found = message;
          }
          return found != nullptr;
        },
        seconds);
    return found;
  }
  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.clear();
  }

 private:
  void add(const Ptr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.push_back(message);
    if (messages_.size() > 200) messages_.pop_front();
  }
  ros::NodeHandle node_;
  std::string topic_;
  mutable std::mutex mutex_;
  std::deque<Ptr> messages_;
  ros::Subscriber subscriber_;
};

/// Publishes pairs as a camera driver does.
class Camera {
 public:
  explicit Camera(const std::string& name, const std::string& image = "image_rect") : node_(name) {
    left_ = node_.advertise<sensor_msgs::Image>("left/" + image, 10);
    right_ = node_.advertise<sensor_msgs::Image>("right/" + image, 10);
    left_info_ = node_.advertise<sensor_msgs::CameraInfo>("left/camera_info", 10);
    right_info_ = node_.advertise<sensor_msgs::CameraInfo>("right/camera_info", 10);
  }
  void publish(const Messages& messages) {
    left_info_.publish(boost::make_shared<sensor_msgs::CameraInfo>(messages.left_info));
    right_info_.publish(boost::make_shared<sensor_msgs::CameraInfo>(messages.right_info));
    left_.publish(boost::make_shared<sensor_msgs::Image>(messages.left));
    right_.publish(boost::make_shared<sensor_msgs::Image>(messages.right));
  }
  std::uint32_t subscribers() const {
    return left_.getNumSubscribers() + right_.getNumSubscribers() + left_info_.getNumSubscribers() +
           right_info_.getNumSubscribers();
  }
  bool waitForSubscribers(std::uint32_t count) const {
    return waitUntil([&] { return subscribers() == count; });
  }

 private:
  ros::NodeHandle node_;
  ros::Publisher left_, right_, left_info_, right_info_;
};

/// Stamps that always grow, 50 ms apart.
inline ros::Time nextStamp() {
  static std::atomic<int> number{0};
  return ros::Time(1000.0) + ros::Duration(0.05 * ++number);
}

/// One nodelet in a namespace, with its camera and its output.
class NodeletGraph {
 public:
  /// params: private parameters, set before the nodelet is loaded.
  explicit NodeletGraph(const std::string& name, const std::map<std::string, XmlRpc::XmlRpcValue>& params = {})
      : name_(name),
        node_(name),
        camera_(name, params.count("rectify") != 0 ? "image_raw" : "image_rect"),
        loader_(false) {
    ros::param::del(nodeletName());
    ros::param::set(nodeletName() + "/disparity_range", 32);
    ros::param::set(nodeletName() + "/diagnostic_period", 0.05);
    for (const auto& [key, value] : params) ros::param::set(nodeletName() + "/" + key, value);
    load();
    disparity_ = std::make_unique<Inbox<stereo_msgs::DisparityImage>>(node_, "disparity");
  }
  ~NodeletGraph() { loader_.unload(nodeletName()); }

  bool load() { return loader_.load(nodeletName(), "fdp_stereo/disparity", {}, {}); }
  bool unload() { return loader_.unload(nodeletName()); }
  std::string nodeletName() const { return name_ + "/disparity_nodelet"; }
  ros::NodeHandle& node() { return node_; }
  Camera& camera() { return camera_; }
  Inbox<stereo_msgs::DisparityImage>& disparity() { return *disparity_; }

  /// Sends the pair, again and again as a camera does, until its disparity comes; null after the time.
  stereo_msgs::DisparityImageConstPtr process(Messages messages, double seconds = 60.0) {
    const ros::Time first = nextStamp();
    const auto fits = [&](const stereo_msgs::DisparityImage& d) { return d.header.stamp >= first; };
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    messages.stamp(first);
    while (std::chrono::steady_clock::now() < end) {
      camera_.publish(messages);
      if (const auto result = disparity_->wait(fits, 0.3)) return result;
      messages.stamp(nextStamp());
    }
    return nullptr;
  }

  /// A live edit; the answer's values. Fails the test where the service does not answer.
  template <typename Fill>
  dynamic_reconfigure::Config edit(Fill&& fill) {
    dynamic_reconfigure::Reconfigure call;
    fill(call.request.config);
    EXPECT_TRUE(ros::service::call(nodeletName() + "/set_parameters", call));
    return call.response.config;
  }

 private:
  std::string name_;
  ros::NodeHandle node_;
  Camera camera_;
  nodelet::Loader loader_;
  std::unique_ptr<Inbox<stereo_msgs::DisparityImage>> disparity_;
};

/// Lines that this process logs.
class LogLines : public ros::console::LogAppender {
 public:
  LogLines() { ros::console::register_appender(this); }
  ~LogLines() override { ros::console::deregister_appender(this); }
  void log(ros::console::Level level, const char* text, const char*, const char*, int) override {
    if (level < ros::console::levels::Warn) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.emplace_back(text);
  }
  std::vector<std::string> lines() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return lines_;
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.clear();
  }
  /// A line with all the parts, "" after the time.
  std::string wait(const std::vector<std::string>& parts, double seconds = 60.0) {
    std::string found;
    waitUntil(
        [&] {
          for (const std::string& line : lines()) {
            const auto has = [&](const std::string& part) { return line.find(part) != std::string::npos; };
            if (std::all_of(parts.begin(), parts.end(), has)) found = line;
          }
          return !found.empty();
        },
        seconds);
    return found;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> lines_;
};

}  // namespace fdp_stereo::test
