// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd.hpp"

namespace fdp_stereo {

/// The paths that meet in one pixel in one sweep: one along the row, one or three from the row before.
/// Path cost arrays hold `count` entries with one readable guard entry on both sides.
template <typename T>
struct PathStep {
  const T* costs;        ///< raw matching costs
  const T* before[4];    ///< path costs of the predecessors
  T* after[4];           ///< path costs of this pixel
  T smallest_before[4];  ///< smallest path cost of each predecessor
  T jump[4];             ///< that + P2
  T smallest_after[4];   ///< of this pixel, written
  T p1;
};

/// Inner loops of semi-global matching, compiled per instruction set.
struct SemiGlobalKernels {
  /// L(p, d) = C + min(L(d), L(d - 1) + P1, L(d + 1) + P1, min L + P2) - min L for `paths` (2 or 4) paths;
  /// their sum is stored in, or with `add` added to, sums.
  void (*stepU8)(PathStep<std::uint8_t>& step, int paths, int count, bool add, std::uint16_t* sums);
  void (*stepU16)(PathStep<std::uint16_t>& step, int paths, int count, bool add, std::uint16_t* sums);
  /// Smallest of values[0 .. count - 1]; 65535 for none.
  std::uint16_t (*minimum)(const std::uint16_t* values, int count);
  /// First index that holds `value`; count when there is none.
  int (*find)(const std::uint16_t* values, int count, std::uint16_t value);
  /// The other view's best: where values[i] < best[i], best[i] = values[i] and best_index[i] = i.
  void (*keepSmaller)(const std::uint16_t* values, int count, std::uint16_t* best, std::uint16_t* best_index);
};
FDP_STEREO_DECLARE_KERNELS(SemiGlobalKernels, semiGlobalKernels)

}  // namespace fdp_stereo
