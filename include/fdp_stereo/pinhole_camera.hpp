// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace fdp_stereo {

/// A rectified camera in px of its image. Points are those of the frame that P projects from; with tx or ty the camera
/// is not at its origin but at (-tx / fx, -ty / fy, 0).
struct PinholeCamera {
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  cv::Size size;
  double tx = 0.0;  ///< px * m
  double ty = 0.0;  ///< px * m

  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {(fx * point.x() + tx) / point.z() + cx, (fy * point.y() + ty) / point.z() + cy};
  }
  Eigen::Vector3d backProject(double u, double v, double z) const {
    return {((u - cx) * z - tx) / fx, ((v - cy) * z - ty) / fy, z};
  }
  /// The same camera with an image of another resolution: pixel areas cover one another.
  PinholeCamera scaled(double x, double y) const {
    const cv::Size other(cvRound(size.width * x), cvRound(size.height * y));
    return {fx * x, fy * y, (cx + 0.5) * x - 0.5, (cy + 0.5) * y - 0.5, other, tx * x, ty * y};
  }
};

}  // namespace fdp_stereo
