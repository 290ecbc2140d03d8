// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <sensor_msgs/CameraInfo.h>
#include <opencv2/core.hpp>

#include "fdp_stereo/pinhole_camera.hpp"

/// What camera_info says of one camera and of a rectified pair. Pure functions.
namespace fdp_stereo {

/// Names of the inputs for messages to people; relative or resolved.
struct StereoTopics {
  std::string left_image = "left/image_rect";
  std::string right_image = "right/image_rect";
  std::string left_info = "left/camera_info";
  std::string right_info = "right/camera_info";
};

/// P of a camera in px of its image as published, while camera_info speaks of the full sensor: binning and region of
/// interest applied, from P where it is set, else from K; nothing is checked.
PinholeCamera pinholeCamera(const sensor_msgs::CameraInfo& info, cv::Size image_size);

/// The same, checked. image_size: px of the image as received. Throws std::invalid_argument naming `topic` where no
/// point can be computed; appends to `warnings` where the calibration is usable but odd.
PinholeCamera checkedCamera(const sensor_msgs::CameraInfo& info, cv::Size image_size, const std::string& topic,
                            std::vector<std::string>& warnings);

/// px of the image that a camera_info describes, binning and region of interest applied; 0 where it does not say.
struct DescribedSize {
  std::uint32_t width;
  std::uint32_t height;
};
DescribedSize describedSize(const sensor_msgs::CameraInfo& info);

/// Geometry of a rectified pair in px of the images as published (binning and region of interest applied).
struct StereoGeometry {
  double focal_px = 0.0;
  double baseline_m = 0.0;    ///< > 0
  double cx_offset_px = 0.0;  ///< cx_left - cx_right: 0 for parallel cameras, not 0 for verged ones
  /// The disparity as published: (x_l - x_r) - (cx_l - cx_r), so that Z = f T / d.
  double published(double disparity) const { return disparity - cx_offset_px; }
  /// m along the optical axis; infinite where the disparity as published is not above 0.
  double depth(double disparity) const;
};

/// Checks a calibration before anything is computed from it. image_size: px of the left image as received. Throws
/// std::invalid_argument where no right depth can come out; appends to `warnings` where the data are usable but odd.
StereoGeometry stereoGeometry(const sensor_msgs::CameraInfo& left, const sensor_msgs::CameraInfo& right,
                              cv::Size image_size, const StereoTopics& topics, std::vector<std::string>& warnings);

}  // namespace fdp_stereo
