// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

/// Samples come in rows of a multiple of this many.
constexpr int kMedianLanes = 8;

/// A window of side x side px in a padded disparity map and the padded planes of the image, one per channel. Up to
/// kMedianLanes - 1 entries right of the window are read, too.
struct MedianWindow {
  const float* disparity;  ///< top left corner; NaN = none
  std::ptrdiff_t disparity_stride;
  const std::uint8_t* planes[3];
  std::ptrdiff_t plane_stride;
  int channels;
  int side;
  std::uint8_t colour[3];     ///< of the centre
  float centre;               ///< disparity of the centre, not NaN
  const std::int32_t* table;  ///< weight by colour distance
};

struct WeightedMedianKernels {
  /// The sample at which the weights of the smaller ones reach one half, to within 1/1024 px. values, weights: memory
  /// for side rows of side entries rounded up to kMedianLanes.
  float (*weightedMedian)(const MedianWindow& window, float* values, std::int32_t* weights);
};
FDP_STEREO_DECLARE_KERNELS(WeightedMedianKernels, weightedMedianKernels)

}  // namespace fdp_stereo
