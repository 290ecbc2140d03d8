// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

/// Paths that meet in a pixel in one sweep, at most: path 0 along the row, the others from the row before.
constexpr int kSweepPaths = 4;

/// One row of a sweep. The costs of one path at one pixel fill a slot: `count` entries and a readable guard entry on
/// both sides. Arrays of the row before start at the predecessor of pixel 0.
template <typename T>
struct SweepRow {
  int width;
  int count;                              ///< entries per pixel, a multiple of 16
  bool backwards;                         ///< from the last pixel to the first
  std::ptrdiff_t slot;                    ///< entries from slot to slot
  T p1;                                   ///< penalty of a step by one disparity
  const T* costs;                         ///< [x][count], raw matching costs
  std::uint16_t* sums;                    ///< [x][count], of all paths
  T* along[2];                            ///< two slots for path 0; the second holds the predecessor of the first pixel
  const T* p2[kSweepPaths];               ///< [path][x], penalty of any other step
  const T* before[kSweepPaths];           ///< [path][x][slot], path 1 on
  T* after[kSweepPaths];                  ///< the same of this row, written
  const T* smallest_before[kSweepPaths];  ///< [path][x], smallest cost in each slot of `before`
  T* smallest_after[kSweepPaths];         ///< the same of `after`, written
};

/// Smallest sums of one pixel: that of the winner, its index (the lowest on ties), and the smallest one that is more
/// than one disparity away from it (65535 for none).
struct Winner {
  std::uint16_t best;
  std::uint16_t index;
  std::uint16_t second;
};

/// Inner loops of semi-global matching, compiled per instruction set.
struct SemiGlobalKernels {
  /// L(p, d) = C + min(L(d), L(d - 1) + P1, L(d + 1) + P1, min L + P2) - min L for `paths` (2 or 4) paths;
  /// their sum is stored in, or with `add` added to, row.sums.
  void (*sweepRowU8)(const SweepRow<std::uint8_t>& row, int paths, bool add);
  void (*sweepRowU16)(const SweepRow<std::uint16_t>& row, int paths, bool add);
  /// Winners of `width` pixels among sums[x * stride .. x * stride + count - 1]; the entries up to the next multiple of
  /// 16 are read, too.
  void (*findWinners)(const std::uint16_t* sums, int stride, int count, int width, Winner* winners);
  /// The other view's best: where values[i] < best[i], best[i] = values[i] and best_index[i] = i.
  void (*keepSmaller)(const std::uint16_t* values, int count, std::uint16_t* best, std::uint16_t* best_index);
};
FDP_STEREO_DECLARE_KERNELS(SemiGlobalKernels, semiGlobalKernels)

}  // namespace fdp_stereo
