// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/matching_cost_kernels.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <int kPlanes>
void absoluteDifferencesOf(const std::int16_t* __restrict left, const std::int16_t* __restrict right, int plane_stride,
                           int count, std::uint16_t limit, std::uint16_t* __restrict sums) {
  for (int i = 0; i < count; ++i) {
    std::uint16_t sum = 0;
    for (int c = 0; c < kPlanes; ++c) {
      const std::int16_t a = left[c];
      const std::int16_t b = right[c * plane_stride + i];
      sum = static_cast<std::uint16_t>(sum + (a > b ? a - b : b - a));
    }
    sums[i] = sum < limit ? sum : limit;
  }
}

void absoluteDifferences(const std::int16_t* left, const std::int16_t* right, int planes, int plane_stride, int count,
                         std::uint16_t limit, std::uint16_t* sums) {
  switch (planes) {
    case 1:
      return absoluteDifferencesOf<1>(left, right, plane_stride, count, limit, sums);
    case 2:
      return absoluteDifferencesOf<2>(left, right, plane_stride, count, limit, sums);
    case 3:
      return absoluteDifferencesOf<3>(left, right, plane_stride, count, limit, sums);
    default:
      return absoluteDifferencesOf<5>(left, right, plane_stride, count, limit, sums);
  }
}

void birchfieldTomasi(const std::int16_t* __restrict left, const std::int16_t* __restrict right, int plane_stride,
                      int count, std::uint16_t limit, std::uint16_t* __restrict sums) {
  const std::int16_t* __restrict value = right;
  const std::int16_t* __restrict smallest = right + plane_stride;
  const std::int16_t* __restrict largest = right + 2 * plane_stride;
  for (int i = 0; i < count; ++i) {
    const int to_right = left[0] > largest[i]    ? left[0] - largest[i]
                         : smallest[i] > left[0] ? smallest[i] - left[0]
                                                 : 0;
    const int to_left = value[i] > left[2] ? value[i] - left[2] : left[1] > value[i] ? left[1] - value[i] : 0;
    const int cost = to_right < to_left ? to_right : to_left;
    sums[i] = static_cast<std::uint16_t>(cost < limit ? cost : limit);
  }
}

void hamming(std::uint64_t left, const std::uint64_t* __restrict right, int count, std::uint16_t weight, bool first,
             std::uint16_t* __restrict sums) {
  if (first) {
    for (int i = 0; i < count; ++i) {
      sums[i] = static_cast<std::uint16_t>(weight * __builtin_popcountll(left ^ right[i]));
    }
  } else {
    for (int i = 0; i < count; ++i) {
      sums[i] = static_cast<std::uint16_t>(sums[i] + weight * __builtin_popcountll(left ^ right[i]));
    }
  }
}

// Vectors of the compiler, with the one instruction that it does not find by itself.
typedef std::uint16_t U16x16 __attribute__((vector_size(32)));
typedef std::uint8_t U8x16 __attribute__((vector_size(16)));

/// Upper halves of the 32-bit products.
inline U16x16 productHigh(const U16x16& a, const U16x16& b) {
#if defined(__AVX2__)
  return reinterpret_cast<U16x16>(_mm256_mulhi_epu16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  __m128i of_a[2], of_b[2];
  __builtin_memcpy(of_a, &a, sizeof(a));
  __builtin_memcpy(of_b, &b, sizeof(b));
  for (int i = 0; i < 2; ++i) of_a[i] = _mm_mulhi_epu16(of_a[i], of_b[i]);
  U16x16 result;
  __builtin_memcpy(&result, of_a, sizeof(result));
  return result;
#else
  U16x16 result;
  for (int i = 0; i < 16; ++i) {
    result[i] = static_cast<std::uint16_t>((static_cast<std::uint32_t>(a[i]) * b[i]) >> 16);
  }
  return result;
#endif
}

inline U16x16 thetaOf(const std::uint16_t* costs, const Theta& theta) {
  U16x16 v;
  __builtin_memcpy(&v, costs, sizeof(v));
  v = v < theta.limit ? v : U16x16{} + theta.limit;
  const U16x16 y = productHigh(v << theta.shift, U16x16{} + theta.factor);
  const U16x16 square = productHigh(productHigh(y, y), U16x16{} + kThetaSquare);
  U16x16 e = ~y + square;  // 65535 - y + ...
  for (int i = 0; i < 4; ++i) e = productHigh(e, e);
  return productHigh(kThetaOne - e, U16x16{} + theta.weight);
}

void combineU8(const std::uint16_t* a, const Theta& theta_a, const std::uint16_t* b, const Theta& theta_b, int count,
               int shift, std::uint8_t* costs) {
  const Theta of_a = theta_a, of_b = theta_b;  // copies that the bytes stored cannot change
  const auto half = static_cast<std::uint16_t>((1U << shift) >> 1);
  for (int i = 0; i < count; i += 16) {
    const U16x16 sum = thetaOf(a + i, of_a) + thetaOf(b + i, of_b) + half;
    const U8x16 rounded = __builtin_convertvector(sum >> static_cast<std::uint16_t>(shift), U8x16);
    __builtin_memcpy(costs + i, &rounded, sizeof(rounded));
  }
}

void combineU16(const std::uint16_t* __restrict a, const std::uint16_t* __restrict table_a,
                const std::uint16_t* __restrict b, const std::uint16_t* __restrict table_b, int count, int shift,
                std::uint16_t* __restrict costs) {
  const std::uint32_t half = (1U << shift) >> 1;
  for (int i = 0; i < count; ++i) {
    costs[i] = static_cast<std::uint16_t>((static_cast<std::uint32_t>(table_a[a[i]]) + table_b[b[i]] + half) >> shift);
  }
}

}  // namespace

const MatchingCostKernels& matchingCostKernels() {
  static const MatchingCostKernels kernels = {absoluteDifferences, birchfieldTomasi, hamming, combineU8, combineU16};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
