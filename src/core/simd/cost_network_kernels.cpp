// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/cost_network_kernels.hpp"

#if defined(__ARM_NEON)
#include <arm_neon.h>
#endif

#include "simd/fixed_point.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

constexpr int kLanes = kShortLanes / 2;
typedef std::int32_t I32s __attribute__((vector_size(4 * kLanes)));

/// Sums of the products of neighbours.
inline I32s productsOfPairs(const I16s& a, const I16s& b) {
#if defined(__AVX2__)
  return reinterpret_cast<I32s>(_mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  return reinterpret_cast<I32s>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#elif defined(__ARM_NEON) && defined(__aarch64__)
  return vpaddq_s32(vmull_s16(vget_low_s16(a), vget_low_s16(b)), vmull_high_s16(a, b));
#else
  I32s sums;
  for (int i = 0; i < kLanes; ++i) sums[i] = a[2 * i] * b[2 * i] + a[2 * i + 1] * b[2 * i + 1];
  return sums;
#endif
}

/// Two neighbouring numbers in all lanes.
inline I16s pairOf(const std::int16_t* from) {
  std::int32_t pair;
  __builtin_memcpy(&pair, from, sizeof(pair));
  return reinterpret_cast<I16s>(I32s{} + pair);
}

template <typename Vector, typename T>
inline Vector load(const T* from) {
  Vector v;
  __builtin_memcpy(&v, from, sizeof(v));
  return v;
}

template <int kVectors, int kPixels>
inline void convolveAt(const Convolution& c, int x, std::int32_t* sums) {
  I32s sum[kPixels][kVectors];
  for (int p = 0; p < kPixels; ++p) {
    for (int v = 0; v < kVectors; ++v) sum[p][v] = load<I32s>(c.biases + v * kLanes);
  }
  const std::int16_t* weights = c.weights;
  for (int row = 0; row < c.row_count; ++row) {
    const std::int16_t* from = c.rows[row] + x * c.inputs;
    for (int k = 0; k < c.pairs; ++k, weights += kVectors * kShortLanes) {
      I16s weight[kVectors];
      for (int v = 0; v < kVectors; ++v) weight[v] = load<I16s>(weights + v * kShortLanes);
      for (int p = 0; p < kPixels; ++p) {
        const I16s input = pairOf(from + p * c.inputs + 2 * k);
        for (int v = 0; v < kVectors; ++v) sum[p][v] += productsOfPairs(input, weight[v]);
      }
    }
  }
  __builtin_memcpy(sums + x * kVectors * kLanes, sum, sizeof(sum));
}

template <int kVectors>
void convolveRow(const Convolution& c, int width, std::int32_t* sums) {
  constexpr int kPixels = kVectors < 12 ? 12 / kVectors : 1;  // what fits the registers
  int x = 0;
  for (; x + kPixels <= width; x += kPixels) convolveAt<kVectors, kPixels>(c, x, sums);
  for (; x < width; ++x) convolveAt<kVectors, 1>(c, x, sums);
}

void convolve(const Convolution& c, int width, std::int32_t* sums) {
  switch (c.outputs) {
    case 8:
      return convolveRow<8 / kLanes>(c, width, sums);
    case 16:
      return convolveRow<16 / kLanes>(c, width, sums);
    case 24:
      return convolveRow<24 / kLanes>(c, width, sums);
    default:
      return convolveRow<32 / kLanes>(c, width, sums);
  }
}

void activate(const std::int32_t* __restrict sums, int count, int shift, std::int16_t* __restrict outputs) {
  constexpr std::int32_t kOne = 4096;
  const std::int32_t half = (1 << shift) >> 1;
  for (int i = 0; i < count; ++i) {
    const std::int32_t wide = (sums[i] + half) >> shift;
    const std::int32_t above = wide > -kOne ? wide : -kOne;
    const std::int32_t x = above < kOne ? above : kOne;
    outputs[i] = static_cast<std::int16_t>((x * (3 * kOne - ((x * x) >> 12)) + (1 << 14)) >> 15);
  }
}

/// Dot products of `left` with 8 or 4 right descriptors.
inline I32s dots(const std::int16_t* left, const std::int16_t* right, int pairs, int stride) {
  I32s sum{};
  for (int k = 0; k < pairs; ++k) {
    sum += productsOfPairs(pairOf(left + 2 * k), load<I16s>(right + 2 * k * stride));
  }
  return sum;
}

void dissimilarities(const std::int16_t* left, const std::int16_t* right, int pairs, int stride, int count,
                     std::uint16_t* values) {
  constexpr std::int32_t kOne = 127 * 127;
  for (int i = 0; i < count; i += kShortLanes) {
    std::int32_t likeness[kShortLanes];
    for (int half = 0; half < kShortLanes; half += kLanes) {
      I32s sum = dots(left, right + 2 * (i + half), pairs, stride) + kOne;
      sum = sum > 0 ? sum : I32s{};
      sum = sum < 2 * kOne ? sum : I32s{} + 2 * kOne;
      __builtin_memcpy(likeness + half, &sum, sizeof(sum));
    }
    U16s u;
    for (int j = 0; j < kShortLanes; ++j) u[j] = static_cast<std::uint16_t>(likeness[j]);
    u = 2 * u + (u >> 5);  // 0 to 65524
    u = productHigh(u, u);
    u = ~productHigh(u, u);
    __builtin_memcpy(values + i, &u, sizeof(u));
  }
}

void mixU8(const std::uint16_t* values, LearnedMix mix, int count, std::uint8_t* costs) {
  const auto others = static_cast<std::uint16_t>(256 - mix.share);
  const auto learned = static_cast<std::uint16_t>(mix.largest * mix.share);
  for (int i = 0; i < count; i += kShortLanes) {
    const U16s before = __builtin_convertvector(load<U8s>(costs + i), U16s);
    const U16s sum = before * others + productHigh(load<U16s>(values + i), U16s{} + learned) + 128;
    const U8s cost = __builtin_convertvector(sum >> 8, U8s);
    __builtin_memcpy(costs + i, &cost, sizeof(cost));
  }
}

void mixU16(const std::uint16_t* __restrict values, LearnedMix mix, int count, std::uint16_t* __restrict costs) {
  for (int i = 0; i < count; ++i) {
    const std::uint32_t learned = (static_cast<std::uint32_t>(values[i]) * mix.largest) >> 16;
    costs[i] = static_cast<std::uint16_t>((costs[i] * (256U - mix.share) + learned * mix.share + 128U) >> 8);
  }
}

}  // namespace

const CostNetworkKernels& costNetworkKernels() {
  static const CostNetworkKernels kernels = {convolve, activate, dissimilarities, mixU8, mixU16};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
