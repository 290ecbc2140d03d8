// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/row_resampling_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <typename T, int kMax>
void combine(const T* const* rows, const std::int32_t* weights, int count, T* __restrict out) {
  static_assert(kResamplingTaps == 6, "the sum below has six terms");
  const T* __restrict r0 = rows[0];
  const T* __restrict r1 = rows[1];
  const T* __restrict r2 = rows[2];
  const T* __restrict r3 = rows[3];
  const T* __restrict r4 = rows[4];
  const T* __restrict r5 = rows[5];
  constexpr std::int32_t kHalf = 1 << (kResamplingBits - 1);
  for (int i = 0; i < count; ++i) {
    const std::int32_t sum = weights[0] * r0[i] + weights[1] * r1[i] + weights[2] * r2[i] + weights[3] * r3[i] +
                             weights[4] * r4[i] + weights[5] * r5[i] + kHalf;
    const std::int32_t value = sum >> kResamplingBits;
    out[i] = static_cast<T>(value < 0 ? 0 : value > kMax ? kMax : value);
  }
}

}  // namespace

const RowResamplingKernels& rowResamplingKernels() {
  static const RowResamplingKernels kernels = {combine<std::uint8_t, 255>, combine<std::uint16_t, 65535>};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
