// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

/// Inner loops of stage 3, compiled per instruction set.
struct CensusKernels {
  /// Adds one bit to each of `count` bytes: bits[i] = bits[i] << 1 | (neighbour[i] < centre[i]).
  void (*compareU8)(const std::uint8_t* neighbour, const std::uint8_t* centre, int count, std::uint8_t* bits);
  void (*compareU16)(const std::uint16_t* neighbour, const std::uint16_t* centre, int count, std::uint8_t* bits);
  /// codes[i] = codes[i] << shift | bits[i].
  void (*append)(const std::uint8_t* bits, int count, int shift, std::uint64_t* codes);
};
FDP_STEREO_DECLARE_KERNELS(CensusKernels, censusKernels)

}  // namespace fdp_stereo
