// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "simd/decay.hpp"

// Fixed-point arithmetic of the kernels, in vectors of the compiler as wide as the registers.
namespace fdp_stereo {
namespace FDP_STEREO_ISA {

#if defined(__AVX2__)
constexpr int kShortLanes = 16;
#else
constexpr int kShortLanes = 8;
#endif
typedef std::uint16_t U16s __attribute__((vector_size(2 * kShortLanes)));
typedef std::int16_t I16s __attribute__((vector_size(2 * kShortLanes)));
typedef std::uint32_t U32s __attribute__((vector_size(4 * kShortLanes)));
typedef std::uint8_t U8s __attribute__((vector_size(kShortLanes)));

/// Upper halves of the 32-bit products: the one instruction that compilers do not find by themselves.
inline U16s productHigh(const U16s& a, const U16s& b) {
#if defined(__AVX2__)
  return reinterpret_cast<U16s>(_mm256_mulhi_epu16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  return reinterpret_cast<U16s>(_mm_mulhi_epu16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return __builtin_convertvector((__builtin_convertvector(a, U32s) * __builtin_convertvector(b, U32s)) >> 16U, U16s);
#endif
}

/// kDecayOne * exp(-v / lambda).
inline U16s decayOf(const U16s& v, const Decay& decay) {
  const U16s limited = v < decay.limit ? v : U16s{} + decay.limit;
  const U16s y = productHigh(limited << decay.shift, U16s{} + decay.factor);
  U16s e = ~y + productHigh(productHigh(y, y), U16s{} + kDecaySquare);  // 65535 - y + ...
  for (int i = 0; i < 4; ++i) e = productHigh(e, e);
  return e;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
