// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "conversions.hpp"
#include "messages.hpp"
#include "point_messages.hpp"

/// A disparity with what the nodelet fdp_stereo/points takes beside it.
namespace fdp_stereo::test {

template <typename Message>
Message& edited(boost::shared_ptr<const Message>& message) {
  auto copy = boost::make_shared<Message>(*message);
  message = copy;
  return *copy;
}

/// A wall; free to be changed.
struct PointScene {
  cv::Mat disparity{120, 160, CV_32FC1, cv::Scalar(kPlaneDisparity)};
  cv::Mat confidence{120, 160, CV_32FC1, cv::Scalar(0.9)};
  cv::Mat depth_error{120, 160, CV_32FC1, cv::Scalar(0.02)};
  cv::Mat image{120, 160, CV_8UC1, cv::Scalar(77)};
  sensor_msgs::CameraInfo info = cameraInfo(160, 120, kFocal, 80.0, 60.0, 0.0);
  ros::Time stamp = ros::Time(1.0);

  PointFrame frame() const {
    std_msgs::Header header;
    header.stamp = stamp;
    header.frame_id = "left_optical";
    auto camera = boost::make_shared<sensor_msgs::CameraInfo>(info);
    camera->header = header;
    const StereoGeometry geometry{kFocal, kBaseline, 0.0};
    return {toDisparityMessage(disparity, header, geometry, {0, 32}, 1.0 / 16.0), camera, toImageMessage(image, header),
            toImageMessage(confidence, header), toImageMessage(depth_error, header)};
  }
};

/// A camera that looks along x of the base, 0.5 m above it.
inline Eigen::Isometry3d baseFromCamera() {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  place.translation() = Eigen::Vector3d(0.0, 0.0, 0.5);
  return place;
}

/// What is wrong with a frame, and parts of what is said of it. Bad: an aggregate of these.
template <typename Bad>
std::vector<Bad> badPointFrames() {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  return {
      {[](PointFrame& f) { edited(f.disparity).f = 0.0F; }, {"disparity: f = 0", "> 0"}},
      {[=](PointFrame& f) { edited(f.disparity).f = nan; }, {"disparity: f = nan"}},
      {[](PointFrame& f) { edited(f.disparity).T = -0.1F; }, {"T = -0.1"}},
      {[](PointFrame& f) { edited(f.disparity).T = std::numeric_limits<float>::infinity(); }, {"T = inf"}},
      {[](PointFrame& f) { edited(f.disparity).image.data.pop_back(); }, {"disparity: data", "truncated"}},
      {[](PointFrame& f) { edited(f.disparity).image.width = 0; }, {"disparity: image of 0 x 120"}},
      {[](PointFrame& f) { edited(f.disparity).image.step = 4; }, {"disparity: step 4"}},
      {[](PointFrame& f) { edited(f.disparity).image.encoding = "mono8"; }, {"disparity", "'mono8'", "32FC1"}},
      {[](PointFrame& f) { edited(f.disparity).image.height = 60; }, {"left/camera_info", "160 x 120", "160 x 60"}},
      {[](PointFrame& f) { edited(f.info).P.fill(0.0); }, {"left/camera_info", "all 0"}},
      {[](PointFrame& f) { edited(f.info).P[0] = -1.0; }, {"left/camera_info", "P[0] = -1"}},
      {[](PointFrame& f) { edited(f.info).width = 320; }, {"left/camera_info", "320 x 120"}},
      {[](PointFrame& f) { edited(f.image).encoding = "32FC1"; }, {"left/image_rect", "'32FC1'"}},
      {[](PointFrame& f) { edited(f.image).data.clear(); }, {"left/image_rect", "0 bytes"}},
      {[](PointFrame& f) { edited(f.image).height = 60; }, {"left/image_rect", "160 x 60", "160 x 120"}},
      {[](PointFrame& f) { edited(f.confidence).encoding = "mono16"; }, {"confidence", "'mono16'"}},
      {[](PointFrame& f) { edited(f.confidence).height = 60; }, {"confidence", "160 x 60", "160 x 120"}},
      {[](PointFrame& f) { edited(f.depth_error).data.resize(10); }, {"depth_error", "10 bytes"}},
      {[](PointFrame& f) { edited(f.depth_error).width = 80; }, {"depth_error", "80 x 120"}},
  };
}

}  // namespace fdp_stereo::test
