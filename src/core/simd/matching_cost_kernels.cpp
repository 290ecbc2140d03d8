// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/matching_cost_kernels.hpp"

#if defined(__ARM_NEON)
#include <arm_neon.h>
#endif

#include "simd/fixed_point.hpp"

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

inline int larger(int a, int b) { return a > b ? a : b; }

void birchfieldTomasi(const std::int16_t* __restrict left, const std::int16_t* __restrict right, int plane_stride,
                      int count, std::uint16_t limit, std::uint16_t* __restrict sums) {
  const std::int16_t* __restrict value = right;
  const std::int16_t* __restrict smallest = right + plane_stride;
  const std::int16_t* __restrict largest = right + 2 * plane_stride;
  const int of_left = left[0], smallest_left = left[1], largest_left = left[2];
  for (int i = 0; i < count; ++i) {
    const int to_right = larger(larger(of_left - largest[i], smallest[i] - of_left), 0);
    const int to_left = larger(larger(value[i] - largest_left, smallest_left - value[i]), 0);
    const int cost = to_right < to_left ? to_right : to_left;
    sums[i] = static_cast<std::uint16_t>(cost < limit ? cost : limit);
  }
}

#if defined(__AVX2__) && !defined(__AVX512VPOPCNTDQ__)

/// Set bits of left ^ right[i], i = 0..3, in the four 64-bit lanes.
inline __m256i distances(__m256i left, const std::uint64_t* right) {
  const __m256i table =
      _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i nibble = _mm256_set1_epi8(15);
  const __m256i bits = _mm256_xor_si256(left, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(right)));
  const __m256i low = _mm256_shuffle_epi8(table, _mm256_and_si256(bits, nibble));
  const __m256i high = _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi16(bits, 4), nibble));
  return _mm256_sad_epu8(_mm256_add_epi8(low, high), _mm256_setzero_si256());
}

/// 16 distances at a time: this instruction set counts the bits of one register only.
void hamming(std::uint64_t left, const std::uint64_t* right, int count, std::uint16_t weight, bool first,
             std::uint16_t* sums) {
  const __m256i lefts = _mm256_set1_epi64x(static_cast<long long>(left));
  const __m256i weights = _mm256_set1_epi16(static_cast<short>(weight));
  const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
  for (int i = 0; i < count; i += 16) {
    const __m256i ab = _mm256_packus_epi32(distances(lefts, right + i), distances(lefts, right + i + 4));
    const __m256i cd = _mm256_packus_epi32(distances(lefts, right + i + 8), distances(lefts, right + i + 12));
    const __m256i bits = _mm256_permutevar8x32_epi32(_mm256_packus_epi32(ab, cd), order);
    auto* to = reinterpret_cast<__m256i*>(sums + i);
    const __m256i weighted = _mm256_mullo_epi16(bits, weights);
    _mm256_storeu_si256(to, first ? weighted : _mm256_add_epi16(weighted, _mm256_loadu_si256(to)));
  }
}

#elif defined(__ARM_NEON) && defined(__aarch64__)

/// Set bits per byte of left ^ right[0] and left ^ right[1].
inline uint8x16_t bitsPerByte(std::uint64_t left, const std::uint64_t* right) {
  return vcntq_u8(vreinterpretq_u8_u64(veorq_u64(vdupq_n_u64(left), vld1q_u64(right))));
}

/// 8 distances at a time: neighbouring bytes are added until one number is left of each code.
void hamming(std::uint64_t left, const std::uint64_t* right, int count, std::uint16_t weight, bool first,
             std::uint16_t* sums) {
  for (int i = 0; i < count; i += 8) {
    const uint8x16_t ab = vpaddq_u8(bitsPerByte(left, right + i), bitsPerByte(left, right + i + 2));
    const uint8x16_t cd = vpaddq_u8(bitsPerByte(left, right + i + 4), bitsPerByte(left, right + i + 6));
    const uint16x8_t weighted = vmulq_n_u16(vpaddlq_u8(vpaddq_u8(ab, cd)), weight);
    vst1q_u16(sums + i, first ? weighted : vaddq_u16(weighted, vld1q_u16(sums + i)));
  }
}

#else

inline std::uint64_t setBits(std::uint64_t x) {
#if defined(__x86_64__) && !defined(__POPCNT__)
  // No instruction counts them, but these vectorise.
  x -= (x >> 1) & 0x5555555555555555U;
  x = (x & 0x3333333333333333U) + ((x >> 2) & 0x3333333333333333U);
  x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fU;
  x += x >> 8;
  x += x >> 16;
  return (x + (x >> 32)) & 127U;
#else
  return static_cast<std::uint64_t>(__builtin_popcountll(x));
#endif
}

void hamming(std::uint64_t left, const std::uint64_t* __restrict right, int count, std::uint16_t weight, bool first,
             std::uint16_t* __restrict sums) {
  for (int i = 0; i < count; ++i) {
    const auto distance = static_cast<std::uint16_t>(weight * setBits(left ^ right[i]));
    sums[i] = first ? distance : static_cast<std::uint16_t>(sums[i] + distance);
  }
}

#endif

#if defined(__AVX2__)
constexpr int kByteLanes = 32;
#else
constexpr int kByteLanes = 16;
#endif
constexpr int kLeastBytes = 16;  // what rows are padded to
typedef std::uint8_t Bytes __attribute__((vector_size(kByteLanes)));

/// Set bits of each byte.
inline Bytes setBits(const Bytes& x) {
#if defined(__AVX512BITALG__)
  return reinterpret_cast<Bytes>(_mm256_popcnt_epi8(reinterpret_cast<__m256i>(x)));
#elif defined(__ARM_NEON)
  return vcntq_u8(x);
#else
  const Bytes pairs = x - ((x >> 1) & 0x55);
  const Bytes nibbles = (pairs & 0x33) + ((pairs >> 2) & 0x33);
  return (nibbles + (nibbles >> 4)) & 0x0f;
#endif
}

/// table[index], index < 64.
inline Bytes lookUp(const CensusTable& table, const Bytes& index) {
#if defined(__AVX512VBMI__)
  const auto* halves = reinterpret_cast<const __m256i*>(table.data());
  return reinterpret_cast<Bytes>(_mm256_permutex2var_epi8(_mm256_loadu_si256(halves), reinterpret_cast<__m256i>(index),
                                                          _mm256_loadu_si256(halves + 1)));
#elif defined(__AVX2__)
  const auto at = reinterpret_cast<__m256i>(index);
  const auto quarter = [&](int k) {
    const __m128i values = _mm_loadu_si128(reinterpret_cast<const __m128i*>(table.data()) + k);
    return _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(values), at);
  };
  const __m256i bit4 = _mm256_slli_epi16(at, 3), bit5 = _mm256_slli_epi16(at, 2);  // in the bytes' highest bits
  return reinterpret_cast<Bytes>(_mm256_blendv_epi8(_mm256_blendv_epi8(quarter(0), quarter(1), bit4),
                                                    _mm256_blendv_epi8(quarter(2), quarter(3), bit4), bit5));
#elif defined(__ARM_NEON) && defined(__aarch64__)
  const std::uint8_t* t = table.data();
  return vqtbl4q_u8({{vld1q_u8(t), vld1q_u8(t + 16), vld1q_u8(t + 32), vld1q_u8(t + 48)}}, index);
#else
  Bytes values;
  for (int i = 0; i < kByteLanes; ++i) values[i] = table[index[i]];
  return values;
#endif
}

template <typename SumAt>
inline void thetaCostsOf(SumAt sumAt, const Theta& theta, int count, int shift, std::uint8_t* costs) {
  const Theta wanted = theta;  // a copy that the bytes stored cannot change
  const auto half = static_cast<std::uint16_t>((1U << shift) >> 1);
  for (int i = 0; i < count; i += kShortLanes) {
    const U16s decay = decayOf(sumAt(i), wanted.decay);
    const U16s value = productHigh(kDecayOne - decay, U16s{} + wanted.weight) + half;
    const U8s cost = __builtin_convertvector(value >> static_cast<std::uint16_t>(shift), U8s);
    __builtin_memcpy(costs + i, &cost, sizeof(cost));
  }
}

void thetaCosts(const std::uint16_t* sums, const Theta& theta, int count, int shift, std::uint8_t* costs) {
  const auto sumAt = [&](int i) {
    U16s sum;
    __builtin_memcpy(&sum, sums + i, sizeof(sum));
    return sum;
  };
  thetaCostsOf(sumAt, theta, count, shift, costs);
}

template <int kPlanes>
void differenceCostsOf(const std::int16_t* left, const std::int16_t* right, int plane_stride, const Theta& theta,
                       int count, int shift, std::uint8_t* costs) {
  I16s of_left[kPlanes];
  for (int c = 0; c < kPlanes; ++c) of_left[c] = I16s{} + left[c];
  const auto sumAt = [&](int i) {
    U16s sum{};
    for (int c = 0; c < kPlanes; ++c) {
      I16s b;
      __builtin_memcpy(&b, right + c * plane_stride + i, sizeof(b));
      const I16s difference = of_left[c] - b;
      sum += reinterpret_cast<U16s>(difference > -difference ? difference : -difference);
    }
    return sum;
  };
  thetaCostsOf(sumAt, theta, count, shift, costs);
}

void differenceCosts(const std::int16_t* left, const std::int16_t* right, int planes, int plane_stride,
                     const Theta& theta, int count, int shift, std::uint8_t* costs) {
  switch (planes) {
    case 1:
      return differenceCostsOf<1>(left, right, plane_stride, theta, count, shift, costs);
    case 2:
      return differenceCostsOf<2>(left, right, plane_stride, theta, count, shift, costs);
    case 3:
      return differenceCostsOf<3>(left, right, plane_stride, theta, count, shift, costs);
    default:
      return differenceCostsOf<5>(left, right, plane_stride, theta, count, shift, costs);
  }
}

template <int kLanes>
inline void addCensusCostsAt(const std::uint8_t* left, int left_stride, const std::uint8_t* right, int right_stride,
                             int planes, const CensusTable& table, const std::uint8_t* others, std::uint8_t* costs) {
  Bytes distance{}, cost{};
  for (int k = 0; k < planes; ++k) {
    Bytes code{};
    __builtin_memcpy(&code, right + k * right_stride, kLanes);
    distance += setBits(code ^ left[k * left_stride]);
  }
  __builtin_memcpy(&cost, others, kLanes);
  cost += lookUp(table, distance < 63 ? distance : Bytes{} + 63);
  __builtin_memcpy(costs, &cost, kLanes);
}

void addCensusCosts(const std::uint8_t* left, int left_stride, const std::uint8_t* right, int right_stride, int planes,
                    int count, const CensusTable& table, const std::uint8_t* others, std::uint8_t* costs) {
  const int padded = (count + kLeastBytes - 1) / kLeastBytes * kLeastBytes;
  if (padded < kByteLanes) {
    return addCensusCostsAt<kLeastBytes>(left, left_stride, right, right_stride, planes, table, others, costs);
  }
  for (int i = 0; i < padded; i += kByteLanes) {
    const int at = i + kByteLanes <= padded ? i : padded - kByteLanes;  // the last ones may be computed twice
    addCensusCostsAt<kByteLanes>(left, left_stride, right + at, right_stride, planes, table, others + at, costs + at);
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
  static const MatchingCostKernels kernels = {absoluteDifferences, birchfieldTomasi, hamming,   thetaCosts,
                                              differenceCosts,     addCensusCosts,   combineU16};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
