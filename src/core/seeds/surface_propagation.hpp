// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/disparity_propagation.hpp"

namespace fdp_stereo {

/// Nearest seed of every pixel along the cheapest way over the image.
struct GeodesicMap {
  cv::Mat distance;  ///< CV_32FC1, -log(trust of the seed) + length of the way
  cv::Mat owner;     ///< CV_32SC1, index of the seed; -1 where there is none
  cv::Mat across;    ///< CV_32FC1, cost of the step to the right neighbour
  cv::Mat down;      ///< CV_32FC1, to the lower one
};

/// A way costs 1 / reach_px per pixel and |dI| / gamma per step (eq. 11's exponent along a
/// path, with a distance term). Ways follow rows and columns; two rounds of four sweeps.
GeodesicMap spreadSeeds(const Seeds& seeds, const cv::Mat& left, double gamma, double reach_px);

/// Disparity plane d = d0 + slope . (position - seed).
struct SeedPlane {
  float d0 = 0.0F;
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();
  float at(const Seed& seed, int x, int y) const {
    return d0 + slope(0) * (static_cast<float>(x) - seed.x) + slope(1) * (static_cast<float>(y) - seed.y);
  }
};

/// A plane per seed by robust least squares over itself and the seeds whose regions touch its own, by nearness.
std::vector<SeedPlane> fitPlanes(const Seeds& seeds, const GeodesicMap& map);

/// The surface form of propagateDisparity().
double propagateSurfaces(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                         DisparityAxis axis, CostVolume& volume);

}  // namespace fdp_stereo
