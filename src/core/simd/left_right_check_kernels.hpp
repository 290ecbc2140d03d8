// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

constexpr int kVoteRadiusPx = 3;
constexpr int kVoteSide = 2 * kVoteRadiusPx + 1;

struct LeftRightCheckKernels {
  /// agreeing[x] = left[x] where one of the two pixels of right beside its match x - left[x] differs from it by up to
  /// max_difference, NaN elsewhere.
  void (*keepAgreeing)(const float* left, const float* right, int width, float max_difference, float* agreeing);
  /// counts[x] = how many of other[x .. x + kVoteSide - 1] differ from own[x] by up to max_difference; NaN never does.
  void (*countAlongRow)(const float* own, const float* other, int width, float max_difference, std::uint8_t* counts);
  /// sums[x] = the counts[k][x] of all rows k whose rows[k][x] differ from own[x] by up to max_difference.
  void (*sumAlongColumns)(const float* own, const float* const* rows, const std::uint8_t* const* counts, int width,
                          float max_difference, std::int32_t* sums);
};
FDP_STEREO_DECLARE_KERNELS(LeftRightCheckKernels, leftRightCheckKernels)

}  // namespace fdp_stereo
