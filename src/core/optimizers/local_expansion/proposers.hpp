// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fdp_stereo/types.hpp"
#include "optimizers/local_expansion/labels.hpp"
#include "optimizers/local_expansion/plane.hpp"
#include "optimizers/local_expansion/random.hpp"

namespace fdp_stereo::local_expansion {

/// A point of a disparity surface.
struct SurfacePoint {
  float x = 0.0F;
  float y = 0.0F;
  float d = 0.0F;
};

struct RansacParams {
  double threshold_px = 1.0;  ///< distance of an inlier
  int samples = 100;          ///< three-point samples at most; fewer once 95 % confidence is reached
};

/// The plane of a random pixel of the rectangle.
Plane proposeExpansion(const Labels& labels, const cv::Rect& core, Random& random);

/// The plane of a random pixel, with its disparity there moved by at most `reach` px (but into the range) and a random
/// vector of length `tilt` added to its unit normal.
Plane proposeRandom(const Labels& labels, const cv::Rect& core, DisparityRange range, float reach, float tilt,
                    Random& random);

/// The plane that most points lie on, by random samples of three points, refined by least squares over all its inliers.
/// Of fewer than three points, or when all lie on a line: the fronto-parallel plane of their median.
Plane fitPlane(std::vector<SurfacePoint>& points, const RansacParams& params, Random& random);

/// fitPlane() to the disparities of a rectangle.
Plane proposeRansac(const Labels& labels, const cv::Rect& core, const RansacParams& params, Random& random,
                    std::vector<SurfacePoint>& points);

/// A plane with disparity d at (x, y) and a normal within max_angle (radians) of fronto-parallel, uniform in the angle.
Plane randomPlane(float x, float y, float d, float max_angle, Random& random);

}  // namespace fdp_stereo::local_expansion
