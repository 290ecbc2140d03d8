// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/propagation_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <typename T, typename Wide>
void blendIn(const T* __restrict prior, int share, int count, T* __restrict raw) {
  const Wide factor = static_cast<Wide>(share);
  for (int i = 0; i < count; ++i) {
    const Wide value = raw[i];
    const Wide difference = static_cast<Wide>(prior[i] - value);
    raw[i] = static_cast<T>(value + (static_cast<Wide>(difference * factor) >> 8));
  }
}

template <typename T>
void blend(const T* __restrict prior, int share, int count, T* __restrict raw) {
  // 255 * 128 fits 16 bits, of which a vector holds twice as many.
  if (sizeof(T) == 1 && share <= 128) return blendIn<T, std::int16_t>(prior, share, count, raw);
  blendIn<T, std::int32_t>(prior, share, count, raw);
}

void relaxRow(const float* __restrict before, const std::int32_t* __restrict owner_before, const float* __restrict step,
              int count, float* __restrict distance, std::int32_t* __restrict owner) {
  for (int i = 0; i < count; ++i) {
    const float over = before[i] + step[i], now = distance[i];
    const std::int32_t shorter = -static_cast<std::int32_t>(over < now);  // a mask: a choice would become a jump
    owner[i] = (owner_before[i] & shorter) | (owner[i] & ~shorter);
    distance[i] = over < now ? over : now;
  }
}

}  // namespace

const PropagationKernels& propagationKernels() {
  static const PropagationKernels kernels = {blend<std::uint8_t>, blend<std::uint16_t>, relaxRow};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
