// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// kWindow: the published one. kSurface: slanted planes over the whole image, along ways of like colour.
enum class PropagationForm { kWindow, kSurface };

/// Stage 6: feature disparity propagation (paper 3.3, algorithm 1, eq. 11).
struct DisparityPropagationParams {
  PropagationForm form = PropagationForm::kSurface;
  int window = 5;          ///< kWindow: W_p is window x window px, odd
  double gamma = 10.0;     ///< eq. (11), grey levels: kWindow: of |dI| from the seed; kSurface: per step along the way
  double reach_px = 30.0;  ///< kSurface: way over even colour at which the weight falls to 1/e
  double strength = 0.5;   ///< kSurface: share 0..1 of the prior in the cost beside a wholly trusted seed
  double spread_px = 1.5;  ///< kSurface: distance from the surface at which the prior reaches 39 % of its height
};

/// Lowers costs near the seeds; returns the share (0..1) of the pixels whose costs it may have changed.
///
/// The window form rounds each seed to the nearest pixel and disparity and takes the seeds in raster order. Raw costs
/// are integers: raw <- (raw * f + 2^15) >> 16 with f = round(2^16 (1 - w(p, q))), so that the seed's own becomes 0.
/// Seeds outside the image or the range are passed over.
///
/// The surface form gives every pixel the seed that is nearest along a way of like colour, fits a plane to each seed
/// and those around it, and blends a prior into all costs of the pixel: raw += share * (prior(d - plane) - raw), where
/// share = strength * trust * exp(-length of the way) and prior(t) = max_raw (1 - exp(-t^2 / (2 spread^2))). It has its
/// minimum at the real-valued surface and is flat there, so that the sub-pixel fit stays with the images.
///
/// left: the left image, 8-bit, 1 or 3 channels, of the volume's size. Throws std::invalid_argument for another image,
/// an even window, or gamma, reach or spread <= 0.
double propagateDisparity(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                          CostVolume& volume);

/// Disparities of a volume with fractions of a pixel: entry i is min + i / steps.
struct DisparityAxis {
  int min = 0;
  int steps = 1;
};
/// The same for such a volume; lengths along the disparities stay in px.
double propagateDisparity(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                          DisparityAxis axis, CostVolume& volume);

}  // namespace fdp_stereo
