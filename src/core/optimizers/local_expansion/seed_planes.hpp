// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "optimizers/local_expansion/plane.hpp"
#include "optimizers/local_expansion/proposers.hpp"

namespace fdp_stereo::local_expansion {

/// The planes of a Delaunay triangulation of sparse disparities: one per pixel, that of the triangle it lies in.
class SeedPlanes {
 public:
  SeedPlanes() = default;
  /// Points outside the image and repeated positions (after the first) are left out; fewer than three give no plane.
  SeedPlanes(const std::vector<SurfacePoint>& points, cv::Size size);

  bool empty() const { return triangle_.empty(); }
  /// The plane at a pixel of the image; false where no triangle covers it.
  bool planeAt(int x, int y, Plane& plane) const;

 private:
  void draw(const SurfacePoint& p, const SurfacePoint& q, const SurfacePoint& r);

  cv::Mat triangle_;  // CV_32SC1: index into planes_, or -1; empty without triangles
  std::vector<Plane> planes_;
};

}  // namespace fdp_stereo::local_expansion
