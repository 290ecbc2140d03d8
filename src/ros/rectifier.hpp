// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <image_geometry/pinhole_camera_model.h>
#include <sensor_msgs/CameraInfo.h>
#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Whether raw images of this camera differ from rectified ones: it has distortion, or R turns them, or K is not P.
bool needsRectification(const sensor_msgs::CameraInfo& info);

/// image_rect, image_rect_color and the like, compressed or not.
bool isRectifiedName(std::string topic);

/// Rectifies the images of one camera as image_proc does; its maps are computed once per calibration.
class Rectifier {
 public:
  /// `raw` itself where there is nothing to rectify. raw: of the size that the calibration describes. Throws
  /// std::invalid_argument naming `topic`, the calibration's, where the image cannot be rectified by it.
  cv::Mat rectify(const cv::Mat& raw, const sensor_msgs::CameraInfo& info, const std::string& topic);
  /// CV_8UC1, 255 where the image rectified last shows nothing, or has black mixed in; empty where it is the raw one.
  const cv::Mat& border() const { return border_; }

 private:
  image_geometry::PinholeCameraModel model_;
  cv::Mat border_;
};

}  // namespace fdp_stereo
