// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/census_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <typename T>
void compare(const T* __restrict neighbour, const T* __restrict centre, int count, std::uint8_t* __restrict bits) {
  for (int i = 0; i < count; ++i) {
    const std::uint8_t bit = neighbour[i] < centre[i] ? 1 : 0;
    bits[i] = static_cast<std::uint8_t>(bits[i] + bits[i] + bit);
  }
}

void append(const std::uint8_t* __restrict bits, int count, int shift, std::uint64_t* __restrict codes) {
  for (int i = 0; i < count; ++i) codes[i] = (codes[i] << shift) | bits[i];
}

}  // namespace

const CensusKernels& censusKernels() {
  static const CensusKernels kernels = {compare<std::uint8_t>, compare<std::uint16_t>, append};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
