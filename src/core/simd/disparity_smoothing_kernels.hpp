// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

struct DisparitySmoothingKernels {
  /// Adds one neighbour to each of `count` pixels: with difference e = near_d - d and |near_i - i| over the channels
  /// (rows `channel_stride` apart), w = max(0, 1 - e^2 * inverse_difference2) / (1 + |dI|^2 * inverse_gamma2);
  /// sums += w * e, weights += w.
  void (*addNeighbour)(const float* d, const float* near_d, const std::uint8_t* image, const std::uint8_t* near_image,
                       int channels, int channel_stride, int count, float inverse_difference2, float inverse_gamma2,
                       float* sums, float* weights);
};
FDP_STEREO_DECLARE_KERNELS(DisparitySmoothingKernels, disparitySmoothingKernels)

}  // namespace fdp_stereo
