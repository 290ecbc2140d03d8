// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "simd/decay.hpp"
#include "simd/simd.hpp"

namespace fdp_stereo {

/// weight * theta (paper eq. 5): theta = 1 - decay.
struct Theta {
  Decay decay;
  std::uint16_t weight;  ///< of the result, kDecayOne being theta = 1
};

/// A cost by the number of bits that differ.
using CensusTable = std::array<std::uint8_t, 64>;

/// Inner loops of stage 4, compiled per instruction set. All work on the disparities of one pixel: entry i belongs to
/// the right pixel right[i], the right row being stored from right to left.
struct MatchingCostKernels {
  /// sums[i] = sum over the planes of |left[c] - right[c * plane_stride + i]|, at most `limit`.
  void (*absoluteDifferences)(const std::int16_t* left, const std::int16_t* right, int planes, int plane_stride,
                              int count, std::uint16_t limit, std::uint16_t* sums);
  /// Birchfield-Tomasi: left and right hold three planes (value, smallest and largest within half a pixel).
  void (*birchfieldTomasi)(const std::int16_t* left, const std::int16_t* right, int plane_stride, int count,
                           std::uint16_t limit, std::uint16_t* sums);
  /// sums[i] (+)= weight * popcount(left ^ right[i]); up to the next multiple of 16 entries are read and written, too.
  void (*hamming)(std::uint64_t left, const std::uint64_t* right, int count, std::uint16_t weight, bool first,
                  std::uint16_t* sums);
  /// costs[i] = (theta(sums[i]) + half) >> shift, for `count` rounded up to a multiple of 16 entries.
  void (*thetaCosts)(const std::uint16_t* sums, const Theta& theta, int count, int shift, std::uint8_t* costs);
  /// The same of the sums that absoluteDifferences() finds.
  void (*differenceCosts)(const std::int16_t* left, const std::int16_t* right, int planes, int plane_stride,
                          const Theta& theta, int count, int shift, std::uint8_t* costs);
  /// costs[i] = others[i] + table[popcount(left ^ right i)] for codes in `planes` bytes of up to 8 bits, byte k of the
  /// left code at left[k * left_stride], of the right ones at right[k * right_stride + i]; 64 differing bits count as
  /// 63. Up to the next multiple of 16 entries are read and written, too.
  void (*addCensusCosts)(const std::uint8_t* left, int left_stride, const std::uint8_t* right, int right_stride,
                         int planes, int count, const CensusTable& table, const std::uint8_t* others,
                         std::uint8_t* costs);
  /// costs[i] = (table_a[a[i]] + table_b[b[i]] + half) >> shift. Tables of fixed-point costs.
  void (*combineU16)(const std::uint16_t* a, const std::uint16_t* table_a, const std::uint16_t* b,
                     const std::uint16_t* table_b, int count, int shift, std::uint16_t* costs);
};
FDP_STEREO_DECLARE_KERNELS(MatchingCostKernels, matchingCostKernels)

}  // namespace fdp_stereo
