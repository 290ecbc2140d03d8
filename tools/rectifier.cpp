// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rectifier.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "conversions.hpp"

namespace fdp_stereo {
namespace {

bool hasDistortion(const sensor_msgs::CameraInfo& info) {
  return std::any_of(info.D.begin(), info.D.end(), [](double d) { return std::abs(d) > 1e-9; });
}

std::string sizeText(int width, int height) { return std::to_string(width) + " x " + std::to_string(height) + " px"; }

}  // namespace

bool needsRectification(const sensor_msgs::CameraInfo& info) {
  constexpr double kTurned = 1e-5;   // rad, less than a hundredth of a pixel at any focal length of a camera
  constexpr double kMovedPx = 0.05;  // of K against P
  constexpr std::array<double, 9> kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (hasDistortion(info)) return true;
  const bool has_r = std::any_of(info.R.begin(), info.R.end(), [](double r) { return r != 0.0; });
  for (std::size_t i = 0; has_r && i < kIdentity.size(); ++i) {
    if (std::abs(info.R[i] - kIdentity[i]) > kTurned) return true;
  }
  const auto moved = [&](std::size_t k, std::size_t p) { return std::abs(info.K[k] - info.P[p]) > kMovedPx; };
  return info.K[0] != 0.0 && (moved(0, 0) || moved(2, 2) || moved(4, 5) || moved(5, 6));
}

sensor_msgs::ImageConstPtr Rectifier::rectify(const sensor_msgs::Image& image, sensor_msgs::CameraInfo info,
                                              const std::string& topic) {
  const cv::Mat raw = decodeImage(image, topic);
  // Without distortion image_geometry gives the image back as it is, whatever R and P say.
  if (!hasDistortion(info) && needsRectification(info)) info.D = {1e-12, 0.0, 0.0, 0.0, 0.0};
  if (info.distortion_model.empty()) info.distortion_model = "plumb_bob";
  model_.fromCameraInfo(info);
  const cv::Size size = model_.reducedResolution();
  if (raw.size() != size) {
    throw std::invalid_argument(topic + ": has " + sizeText(raw.cols, raw.rows) + ", its calibration describes " +
                                sizeText(size.width, size.height) + "; calibrate this resolution");
  }
  cv::Mat rectified;
  model_.rectifyImage(raw, rectified);
  return toImageMessage(rectified, image.header);
}

}  // namespace fdp_stereo
