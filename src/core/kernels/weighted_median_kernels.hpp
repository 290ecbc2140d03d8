// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd.hpp"

namespace fdp_stereo {

struct WeightedMedianKernels {
  /// Sum of the weights of all values up to `limit`.
  std::int32_t (*weightUpTo)(const float* values, const std::int32_t* weights, int count, float limit);
};
FDP_STEREO_DECLARE_KERNELS(WeightedMedianKernels, weightedMedianKernels)

}  // namespace fdp_stereo
