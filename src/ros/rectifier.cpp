// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rectifier.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "text.hpp"

namespace fdp_stereo {
namespace {

using sensor_msgs::CameraInfo;

constexpr std::array<double, 9> kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};

bool hasDistortion(const CameraInfo& info) {
  return std::any_of(info.D.begin(), info.D.end(), [](double d) { return std::abs(d) > 1e-9; });
}

bool turns(const CameraInfo& info) {
  return std::any_of(info.R.begin(), info.R.end(), [](double r) { return r != 0.0; });
}

template <typename Values>
void requireFinite(const Values& values, const char* name, const std::string& topic) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) fail(topic, ": ", name, "[", i, "] = ", values[i], "; calibrate the camera anew");
  }
}

void requireRotation(const CameraInfo& info, const std::string& topic) {
  constexpr double kRounding = 1e-2;  // of a file with few digits
  const cv::Matx33d r(info.R.data());
  if (turns(info) && cv::norm(r * r.t() - cv::Matx33d::eye(), cv::NORM_INF) > kRounding) {
    fail(topic, ": R is no rotation; calibrate the cameras anew, or leave R 0 for none");
  }
}

void requireModel(const CameraInfo& info, const std::string& topic) {
  const std::string& model = info.distortion_model;
  const std::size_t count = info.D.size();
  const bool brown = model.empty() || model == "plumb_bob" || model == "rational_polynomial";
  const bool possible = brown ? count == 4 || count == 5 || count == 8 || count == 12 || count == 14
                              : model == "equidistant" && count == 4;
  if (possible || !hasDistortion(info)) return;
  fail(topic, ": distortion_model ", quoteForLog(model), " with ", count,
       " values of D; plumb_bob has 4 or 5, rational_polynomial 8, equidistant 4");
}

/// What image_geometry and OpenCV take as it comes.
void requireUsable(const CameraInfo& info, const std::string& topic) {
  constexpr std::uint64_t kMostPixels = 1 << 27;  // of the full sensor, for which the maps are made
  requireFinite(info.D, "D", topic);
  requireFinite(info.K, "K", topic);
  requireFinite(info.R, "R", topic);
  if (!(info.K[0] > 0.0 && info.K[4] > 0.0)) {
    fail(topic, ": focal length K[0] = ", info.K[0], ", K[4] = ", info.K[4],
         " must be > 0 for raw images to be rectified; calibrate the camera");
  }
  requireRotation(info, topic);
  requireModel(info, topic);
  if (std::uint64_t{info.width} * info.height > kMostPixels) {
    fail(topic, ": describes ", info.width, " x ", info.height, " px, at most ", kMostPixels,
         " px can be rectified; load the calibration of this camera");
  }
}

/// The calibration as image_geometry understands it.
CameraInfo completed(CameraInfo info, cv::Size image) {
  if (info.width == 0 || info.height == 0) {
    info.width = static_cast<std::uint32_t>(image.width);
    info.height = static_cast<std::uint32_t>(image.height);
  }
  info.roi.do_rectify = false;  // the pixels of the raw image's place
  if (!turns(info)) std::copy(kIdentity.begin(), kIdentity.end(), info.R.begin());
  if (info.distortion_model.empty()) info.distortion_model = "plumb_bob";
  if (!hasDistortion(info)) {  // else R and P have no effect
    info.distortion_model = "plumb_bob";
    info.D = {1e-12, 0.0, 0.0, 0.0, 0.0};
  }
  return info;
}

cv::Mat borderOf(const image_geometry::PinholeCameraModel& model, cv::Size size) {
  cv::Mat shown;
  model.rectifyImage(cv::Mat(size, CV_8UC1, cv::Scalar(255)), shown);
  return shown < 255;
}

}  // namespace

bool needsRectification(const CameraInfo& info) {
  constexpr double kTurned = 1e-5;   // rad, less than a hundredth of a pixel at any focal length of a camera
  constexpr double kMovedPx = 0.05;  // of K against P
  if (hasDistortion(info)) return true;
  for (std::size_t i = 0; turns(info) && i < kIdentity.size(); ++i) {
    if (std::abs(info.R[i] - kIdentity[i]) > kTurned) return true;
  }
  const auto moved = [&](std::size_t k, std::size_t p) { return std::abs(info.K[k] - info.P[p]) > kMovedPx; };
  return info.K[0] != 0.0 && (moved(0, 0) || moved(2, 2) || moved(4, 5) || moved(5, 6));
}

bool isRectifiedName(std::string topic) {
  const std::size_t transport = topic.rfind("/compressed");
  if (transport != std::string::npos) topic.resize(transport);
  const std::string name = topic.substr(topic.rfind('/') + 1);
  return name.find("rect") != std::string::npos && name.find("unrect") == std::string::npos;
}

cv::Mat Rectifier::rectify(const cv::Mat& raw, const CameraInfo& info, const std::string& topic) {
  requireFinite(info.D, "D", topic);  // NaN compares as no distortion
  if (!needsRectification(info)) {
    border_.release();
    return raw;
  }
  requireUsable(info, topic);
  try {
    if (model_.fromCameraInfo(completed(info, raw.size()))) border_.release();
    cv::Mat rectified;
    model_.rectifyImage(raw, rectified);
    if (border_.empty()) border_ = borderOf(model_, raw.size());
    if (cv::countNonZero(border_ == 0) > 0) return rectified;
  } catch (const image_geometry::Exception& error) {
    fail(topic, ": ", error.what());
  }
  fail(topic, ": rectified by it the image shows nothing; are K, R and P of one calibration, and of this camera?");
}

}  // namespace fdp_stereo
