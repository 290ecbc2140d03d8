// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

/// Inner loops of the surface form of the propagation.
struct PropagationKernels {
  /// raw[i] += (prior[i] - raw[i]) * share / 256, rounded down; share 0..255.
  void (*blend8)(const std::uint8_t* prior, int share, int count, std::uint8_t* raw);
  void (*blend16)(const std::uint16_t* prior, int share, int count, std::uint16_t* raw);
  /// Where the way over the row before costs less: distance[i] = before[i] + step[i], owner[i] = owner_before[i].
  void (*relaxRow)(const float* before, const std::int32_t* owner_before, const float* step, int count, float* distance,
                   std::int32_t* owner);
};

FDP_STEREO_DECLARE_KERNELS(PropagationKernels, propagationKernels)

}  // namespace fdp_stereo
