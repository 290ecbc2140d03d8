// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "fdp_stereo/pinhole_camera.hpp"

namespace fdp_stereo {

struct RangeScanParams {
  double min_height_m = 0.1;    ///< of an obstacle, along z of the frame of the scan
  double max_height_m = 1.0;    ///< likewise
  double min_range_m = 0.1;     ///< from the z axis of that frame
  double max_range_m = 5.0;     ///< likewise
  double increment_rad = 0.01;  ///< between two bearings
};

/// What a scan is made of.
struct SeenDepth {
  PinholeCamera camera;
  cv::Mat depth;       ///< CV_32FC1 m, NaN = none: of what is answered and can be trusted
  cv::Mat free_depth;  ///< CV_32FC1 m, per square of `spacing` px: down to where its ray is free, NaN = not known
  int spacing = 8;     ///< px
  /// m: the nearest depth that can be seen. What lies between it and the camera is not judged.
  double nearest = 0.0;
};

/// Nearest obstacles around the z axis of a frame.
struct RangeScan {
  double first_bearing = 0.0;  ///< rad, from x to y
  double increment = 0.0;      ///< rad
  std::vector<float> ranges;   ///< m; params.max_range_m = free up to there, NaN = not known
};

/// Per bearing the nearest point between the two heights. Where there is none, a bearing is free if every ray that
/// enters the space between the heights is known to be free until it leaves it or has the largest range, and at least
/// one has that. The bearings are those that the camera sees.
RangeScan scanRanges(const SeenDepth& seen, const Eigen::Isometry3d& scan_from_camera, const RangeScanParams& params);

}  // namespace fdp_stereo
