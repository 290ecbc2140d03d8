// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <sensor_msgs/CameraInfo.h>

namespace fdp_stereo {

/// A YAML file as camera_calibration writes it. Throws std::runtime_error naming the file, the key and what is wanted.
sensor_msgs::CameraInfo readCalibration(const std::string& path);

}  // namespace fdp_stereo
