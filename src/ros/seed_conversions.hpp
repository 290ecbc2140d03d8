// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <sensor_msgs/PointCloud2.h>
#include <Eigen/Geometry>

#include "conversions.hpp"

/// What other sensors know, as seeds of the left image. Pure functions; every size is checked before use.
namespace fdp_stereo {

/// How a source is believed, and how densely it is taken.
struct SeedQuality {
  double trust = 0.95;      ///< 0..1, share of its seeds that are right
  double spacing_px = 4.0;  ///< at most one seed per square of this side, the nearest point
};

using Points = std::vector<Eigen::Vector3d>;

/// x, y, z of the points that are finite. Throws std::invalid_argument naming `topic` for a layout that is not that of
/// its data, or without float x, y, z.
Points pointsOfCloud(const sensor_msgs::PointCloud2& cloud, const std::string& topic);

/// Points of a depth image (16UC1 in mm or 32FC1 in m, 0 or NaN = none) in the frame of its camera, every
/// `stride`-th pixel both ways. Throws std::invalid_argument naming `topic`.
Points pointsOfDepth(const sensor_msgs::Image& depth, const sensor_msgs::CameraInfo& info, int stride,
                     const std::string& topic);

/// Points of a disparity image with its f and T, seen by a camera with the left camera's centre of projection and
/// field of view but any resolution. Throws std::invalid_argument naming `topic`.
Points pointsOfDisparity(const stereo_msgs::DisparityImage& disparity, const PinholeCamera& left, int stride,
                         const std::string& topic);

/// Points in the frame of the left camera to seeds (disparities of the pixels as given, not published ones). Of the
/// points in a square of spacing_px only the nearest counts, and a point clearly behind one in a square beside it is
/// taken as hidden.
Seeds projectSeeds(const Points& points, const PinholeCamera& left, const StereoGeometry& geometry,
                   const SeedQuality& quality, SeedSource source);

}  // namespace fdp_stereo
