// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <boost/make_shared.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "frame_worker.hpp"

/// Messages for tests, written apart from src/ros/conversions.cpp.
namespace fdp_stereo::test {

/// The text of the exception, "" where none is thrown.
inline std::string errorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

inline void expectContains(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' in: " << text;
}

inline sensor_msgs::Image imageMessage(const cv::Mat& pixels, const std::string& encoding, std::uint32_t padding = 0) {
  sensor_msgs::Image message;
  message.header.frame_id = "left_optical";
  message.width = static_cast<std::uint32_t>(pixels.cols);
  message.height = static_cast<std::uint32_t>(pixels.rows);
  message.encoding = encoding;
  message.step = message.width * static_cast<std::uint32_t>(pixels.elemSize()) + padding;
  for (int y = 0; y < pixels.rows; ++y) {
    const auto* row = pixels.ptr<std::uint8_t>(y);
    message.data.insert(message.data.end(), row, row + pixels.cols * pixels.elemSize());
    message.data.insert(message.data.end(), padding, std::uint8_t{0xAB});
  }
  return message;
}

/// tx = -f * baseline for the right camera, 0 for the left.
inline sensor_msgs::CameraInfo cameraInfo(int width, int height, double f, double cx, double cy, double tx) {
  sensor_msgs::CameraInfo info;
  info.header.frame_id = "left_optical";
  info.width = static_cast<std::uint32_t>(width);
  info.height = static_cast<std::uint32_t>(height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {f, 0.0, cx, tx, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// A textured plane facing the cameras: left(x) = right(x - disparity), CV_8UC1.
struct PlanePair {
  cv::Mat left;
  cv::Mat right;
};

inline PlanePair planePair(int width, int height, int disparity, unsigned seed = 1) {
  cv::Mat texture(height, width + disparity, CV_8UC1);
  cv::RNG rng(seed);
  rng.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(), 1.0);
  cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
  return {texture.colRange(0, width).clone(), texture.colRange(disparity, disparity + width).clone()};
}

/// The four messages of a pair, free to be changed.
struct Messages {
  sensor_msgs::Image left;
  sensor_msgs::Image right;
  sensor_msgs::CameraInfo left_info;
  sensor_msgs::CameraInfo right_info;

  void stamp(const ros::Time& time) {
    left.header.stamp = right.header.stamp = left_info.header.stamp = right_info.header.stamp = time;
  }
  StereoFrame frame() const {
    return {boost::make_shared<sensor_msgs::Image>(left), boost::make_shared<sensor_msgs::Image>(right),
            boost::make_shared<sensor_msgs::CameraInfo>(left_info),
            boost::make_shared<sensor_msgs::CameraInfo>(right_info), std::chrono::steady_clock::now()};
  }
};

/// What a camera with this calibration sees where a rectified one sees `rectified`.
inline cv::Mat rawImage(const cv::Mat& rectified, const sensor_msgs::CameraInfo& info) {
  std::vector<cv::Point2f> places;
  for (int y = 0; y < rectified.rows; ++y) {
    for (int x = 0; x < rectified.cols; ++x) places.emplace_back(x, y);
  }
  std::vector<cv::Point2f> seen;
  cv::undistortPoints(places, seen, cv::Matx33d(info.K.data()), info.D, cv::Matx33d(info.R.data()),
                      cv::Matx34d(info.P.data()));
  cv::Mat raw;
  cv::remap(rectified, raw, cv::Mat(seen).reshape(2, rectified.rows), cv::noArray(), cv::INTER_CUBIC);
  return raw;
}

constexpr int kPlaneDisparity = 9;
constexpr double kFocal = 200.0;
constexpr double kBaseline = 0.1;

/// A good pair, 160 x 120 px, of a plane at kFocal * kBaseline / kPlaneDisparity.
inline Messages goodMessages(int width = 160, int height = 120) {
  const PlanePair pair = planePair(width, height, kPlaneDisparity);
  Messages messages{imageMessage(pair.left, "mono8"), imageMessage(pair.right, "mono8"),
                    cameraInfo(width, height, kFocal, width / 2.0, height / 2.0, 0.0),
                    cameraInfo(width, height, kFocal, width / 2.0, height / 2.0, -kFocal * kBaseline)};
  messages.stamp(ros::Time(1.0));
  return messages;
}

/// The same as its cameras see it before it is rectified: distorted, turned, of other focal lengths.
inline Messages rawMessages() {
  Messages messages = goodMessages(240, 180);
  const PlanePair pair = planePair(240, 180, kPlaneDisparity);
  const auto spoil = [](sensor_msgs::CameraInfo& info, const cv::Mat& rectified, double turn) {
    info.D = {-0.25, 0.06, 0.0005, -0.0003, 0.0};
    info.K = {225.0, 0.0, 118.0, 0.0, 226.0, 92.0, 0.0, 0.0, 1.0};
    cv::Mat rotation;
    cv::Rodrigues(cv::Vec3d(0.01, turn, -0.015), rotation);
    std::copy(rotation.begin<double>(), rotation.end<double>(), info.R.begin());
    return imageMessage(rawImage(rectified, info), "mono8");
  };
  messages.left = spoil(messages.left_info, pair.left, 0.02);
  messages.right = spoil(messages.right_info, pair.right, -0.01);
  messages.stamp(ros::Time(1.0));
  return messages;
}

/// The good pair with the noise of a sensor, another one for every `number`.
inline Messages noisyMessages(int number, double seconds) {
  Messages messages = goodMessages();
  cv::RNG random(static_cast<std::uint64_t>(number) + 1);
  for (sensor_msgs::Image* image : {&messages.left, &messages.right}) {
    for (std::uint8_t& value : image->data) value = cv::saturate_cast<std::uint8_t>(value + random.gaussian(3.0));
  }
  messages.stamp(ros::Time(seconds));
  return messages;
}

}  // namespace fdp_stereo::test
