// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "fdp_stereo/subpixel.hpp"
#include "simd/simd.hpp"

namespace fdp_stereo {

/// Paths that are followed side by side, for what one waits for the others can do.
constexpr int kBundleLines = 4;

/// What becomes of the excess L - C of a path over the costs. Three paths keep their sum in as many bits as a cost has,
/// or the largest number where it is more; the fourth yields the sum of all four path costs.
enum class PathSum {
  kFirst,  ///< excess = L - C
  kNext,   ///< excess += L - C
  kLast    ///< totals = 4 C + excess + L - C
};

/// Paths of one direction along neighbouring rows or columns. The costs of one path at one pixel fill a slot: `count`
/// entries and a readable guard entry on both sides. Every pixel exchanges the two slots of its path, so that after an
/// even number of pixels the last one is in `before` again, after an odd number in `after`.
template <typename T>
struct PathBundle {
  int length;                           ///< pixels of each path
  int count;                            ///< entries per pixel, a multiple of 16
  std::ptrdiff_t step;                  ///< from pixel to pixel, in entries of the costs
  std::ptrdiff_t sums_step;             ///< the same of excess and totals
  std::ptrdiff_t p2_step;               ///< from pixel to pixel, in entries of p2
  T p1;                                 ///< penalty of a step by one disparity
  const T* costs[kBundleLines];         ///< raw matching costs of the first pixel
  T* excess[kBundleLines];              ///< sums of L - C
  std::uint16_t* totals[kBundleLines];  ///< kLast only
  const T* p2[kBundleLines];            ///< penalty of any other step
  T* before[kBundleLines];              ///< slot of the predecessor
  T* after[kBundleLines];               ///< the other slot
  T* smallest;                          ///< [line], smallest cost of the predecessor, then of the last pixel
};

/// Smallest sums of one pixel: that of the winner, its index (the lowest on ties), and the smallest one that is more
/// than one disparity away from it (65535 for none).
struct Winner {
  std::uint16_t best;
  std::uint16_t index;
  std::uint16_t second;
};

/// The smallest sums of many pixels and those at the disparities before and after.
struct Minima {
  const std::uint16_t* before;
  const std::uint16_t* best;
  const std::uint16_t* after;
};

constexpr int kSumsRead = 32;  ///< findWinners() reads so many sums at once, also beyond the last pixel

/// Inner loops of semi-global matching, compiled per instruction set.
struct SemiGlobalKernels {
  /// L(p, d) = C + min(L(d), L(d - 1) + P1, L(d + 1) + P1, min L + P2) - min L along 1 or kBundleLines paths.
  void (*followU8)(const PathBundle<std::uint8_t>& bundle, int lines, PathSum sum);
  void (*followU16)(const PathBundle<std::uint16_t>& bundle, int lines, PathSum sum);
  /// Winners of `width` pixels among sums[x * stride .. x * stride + count - 1]; the entries up to the next multiple of
  /// kSumsRead are read, too.
  void (*findWinners)(const std::uint16_t* sums, int stride, int count, int width, Winner* winners);
  /// The other view's best: where values[i] < best[i], best[i] = values[i] and best_index[i] = first + i.
  void (*keepSmaller)(const std::uint16_t* values, int first, int count, std::uint16_t* best,
                      std::uint16_t* best_index);
  /// subpixelOffset() of `count` pixels.
  void (*subpixelOffsets)(SubpixelFit fit, const Minima& minima, int count, float* offsets);
};
FDP_STEREO_DECLARE_KERNELS(SemiGlobalKernels, semiGlobalKernels)

}  // namespace fdp_stereo
