// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

/// Messages for tests, written apart from src/ros/conversions.cpp.
namespace fdp_stereo::test {

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

}  // namespace fdp_stereo::test
