// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/decay.hpp"
#include "simd/simd.hpp"

namespace fdp_stereo {

/// Samples come in rows of a multiple of this many, read also right of and below the window.
constexpr int kMedianLanes = 8;
/// No disparity. Others rise by one per step of the map's resolution.
constexpr std::int16_t kNoSample = -32768;

/// A window of side x side px in a padded disparity map and the padded planes of the image, one per channel.
struct MedianWindow {
  const std::int16_t* samples;  ///< top left corner
  std::ptrdiff_t sample_stride;
  const std::uint8_t* planes[3];
  std::ptrdiff_t plane_stride;
  int channels;
  int side;
  std::uint8_t colour[3];  ///< of the centre
};

/// What a sample weighs by its colour distance from the centre: `largest` times the decay. The weights of all samples
/// of a window add up to less than 2^16.
struct MedianWeight {
  Decay decay;
  std::uint16_t largest;
};

struct WeightedMedianKernels {
  /// The sample at which the weights of the smaller ones reach one half; one is there. values, weights: memory for
  /// side + 1 rows of side entries rounded up to kMedianLanes.
  std::int16_t (*weightedMedian)(const MedianWindow& window, const MedianWeight& weight, std::int16_t* values,
                                 std::uint16_t* weights);
};
FDP_STEREO_DECLARE_KERNELS(WeightedMedianKernels, weightedMedianKernels)

}  // namespace fdp_stereo
