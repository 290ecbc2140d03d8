// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/left_right_check_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

inline bool alike(float a, float b, float max_difference) {
  const float difference = a - b;
  return (difference < 0.0F ? -difference : difference) <= max_difference;
}

void countAlongRow(const float* __restrict own, const float* __restrict other, int width, float max_difference,
                   std::int32_t* __restrict counts) {
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    std::int32_t count = 0;
    for (int k = 0; k < kVoteSide; ++k) count += alike(own[x], other[x + k], max_difference) ? 1 : 0;
    counts[x] = count;
  }
}

void sumAlongColumns(const float* __restrict own, const float* const* rows, const std::int32_t* const* counts,
                     int width, float max_difference, std::int32_t* __restrict sums) {
  for (int x = 0; x < width; ++x) sums[x] = 0;
  for (int k = 0; k < kVoteSide; ++k) {
    const float* __restrict row = rows[k];
    const std::int32_t* __restrict count = counts[k];
#pragma omp simd
    for (int x = 0; x < width; ++x) sums[x] += alike(own[x], row[x], max_difference) ? count[x] : 0;
  }
}

}  // namespace

const LeftRightCheckKernels& leftRightCheckKernels() {
  static const LeftRightCheckKernels kernels = {countAlongRow, sumAlongColumns};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
