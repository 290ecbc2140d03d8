// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/left_right_check_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

constexpr float kNone = __builtin_nanf("");

inline bool alike(float a, float b, float max_difference) { return __builtin_fabsf(a - b) <= max_difference; }

/// In blocks: what is gathered one by one stands between loops that compute many at a time.
void keepAgreeing(const float* __restrict left, const float* __restrict right, int width, float max_difference,
                  float* __restrict agreeing) {
  constexpr int kBlock = 64;
  const auto last = static_cast<float>(width - 1);
  std::int32_t before[kBlock];
  float at_before[kBlock], at_after[kBlock];
  for (int start = 0; start < width; start += kBlock) {
    const int count = width - start < kBlock ? width - start : kBlock;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const float match = static_cast<float>(start + i) - left[start + i];
      before[i] = static_cast<std::int32_t>(match >= 0.0F && match <= last ? match : 0.0F);
    }
    for (int i = 0; i < count; ++i) {
      at_before[i] = right[before[i]];
      at_after[i] = right[before[i] + 1 < width ? before[i] + 1 : width - 1];
    }
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const float d = left[start + i], match = static_cast<float>(start + i) - d;
      const int inside = static_cast<int>(match >= 0.0F) & static_cast<int>(match <= last);
      const int between = static_cast<int>(match > static_cast<float>(before[i]));
      const int agrees = static_cast<int>(alike(d, at_before[i], max_difference)) |
                         (between & static_cast<int>(alike(d, at_after[i], max_difference)));
      agreeing[start + i] = (inside & agrees) != 0 ? d : kNone;
    }
  }
}

void countAlongRow(const float* __restrict own, const float* __restrict other, int width, float max_difference,
                   std::uint8_t* __restrict counts) {
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    std::int32_t count = 0;
    for (int k = 0; k < kVoteSide; ++k) count += alike(own[x], other[x + k], max_difference) ? 1 : 0;
    counts[x] = static_cast<std::uint8_t>(count);
  }
}

void sumAlongColumns(const float* __restrict own, const float* const* rows, const std::uint8_t* const* counts,
                     int width, float max_difference, std::int32_t* __restrict sums) {
  const float* row[kVoteSide];
  const std::uint8_t* count[kVoteSide];
  for (int k = 0; k < kVoteSide; ++k) {
    row[k] = rows[k];
    count[k] = counts[k];
  }
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    std::int32_t sum = 0;
#pragma GCC unroll 7
    for (int k = 0; k < kVoteSide; ++k) {
      sum += static_cast<std::int32_t>(alike(own[x], row[k][x], max_difference)) * count[k][x];
    }
    sums[x] = sum;
  }
}

}  // namespace

const LeftRightCheckKernels& leftRightCheckKernels() {
  static const LeftRightCheckKernels kernels = {keepAgreeing, countAlongRow, sumAlongColumns};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
