// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <image_geometry/pinhole_camera_model.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

namespace fdp_stereo {

/// Whether raw images of this camera differ from rectified ones: it has distortion, or R turns them, or K is not P.
bool needsRectification(const sensor_msgs::CameraInfo& info);

/// Rectifies the images of one camera as image_proc does.
class Rectifier {
 public:
  /// Throws std::invalid_argument or image_geometry::Exception naming `topic` where the calibration does not fit.
  sensor_msgs::ImageConstPtr rectify(const sensor_msgs::Image& image, sensor_msgs::CameraInfo info,
                                     const std::string& topic);

 private:
  image_geometry::PinholeCameraModel model_;
};

}  // namespace fdp_stereo
