// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/weighted_median_kernels.hpp"

#include "simd/fixed_point.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

constexpr int kRows = kShortLanes / kMedianLanes;  // of the window in one vector

template <typename Vector, typename T>
inline Vector load(const T* from) {
  Vector v;
  __builtin_memcpy(&v, from, sizeof(v));
  return v;
}

template <typename Vector, typename T>
inline void store(const Vector& v, T* to) {
  __builtin_memcpy(to, &v, sizeof(v));
}

/// kMedianLanes entries from each of kRows rows.
inline I16s loadSamples(const std::int16_t* first, std::ptrdiff_t stride) {
#if defined(__AVX2__)
  const auto* second = reinterpret_cast<const __m128i*>(first + stride);
  const __m128i lower = _mm_loadu_si128(reinterpret_cast<const __m128i*>(first));
  return reinterpret_cast<I16s>(_mm256_inserti128_si256(_mm256_castsi128_si256(lower), _mm_loadu_si128(second), 1));
#else
  return load<I16s>(first + 0 * stride);
#endif
}

inline I16s loadColours(const std::uint8_t* first, std::ptrdiff_t stride) {
#if defined(__AVX2__)
  const __m128i lower = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(first));
  const __m128i upper = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(first + stride));
  return reinterpret_cast<I16s>(_mm256_cvtepu8_epi16(_mm_unpacklo_epi64(lower, upper)));
#else
  return __builtin_convertvector(load<U8s>(first + 0 * stride), I16s);
#endif
}

typedef std::uint32_t U32x4 __attribute__((vector_size(16)));

/// Sums of neighbouring lanes, and of both halves of a wider vector.
inline U32x4 fourSums(const U16s& v) {
  U32x4 parts[kRows];
  __builtin_memcpy(parts, &v, sizeof(v));
  U32x4 sums = {};
  for (const U32x4& part : parts) sums += (part & 0xffffU) + (part >> 16U);
  return sums;
}

inline int sumOf(const U16s& v) {
  const U32x4 sums = fourSums(v);
  return static_cast<int>(sums[0] + sums[1] + sums[2] + sums[3]);
}

/// What is known of the samples of a window.
struct Samples {
  std::int16_t low, high;
  int total;
  int count;
};

/// Sum of the absolute differences from the colour of the centre.
inline U16s colourDistance(const MedianWindow& window, int v, int j) {
  I16s distance = {};
  for (int c = 0; c < window.channels; ++c) {
    const auto* pixels = window.planes[c] + v * window.plane_stride + j;
    const I16s difference = loadColours(pixels, window.plane_stride) - static_cast<std::int16_t>(window.colour[c]);
    distance += difference < 0 ? -difference : difference;
  }
  return reinterpret_cast<U16s>(distance);
}

/// Fills values and weights; a neighbour without disparity, or beyond the window, weighs nothing.
Samples gather(const MedianWindow& window, const MedianWeight& weight, std::int16_t* values, std::uint16_t* weights) {
  I16s column, row;
  for (int i = 0; i < kShortLanes; ++i) {
    column[i] = static_cast<std::int16_t>(i % kMedianLanes);
    row[i] = static_cast<std::int16_t>(i / kMedianLanes);
  }
  const auto side = static_cast<std::int16_t>(window.side);
  I16s low = I16s{} + static_cast<std::int16_t>(32767), high = I16s{} + kNoSample;
  U16s total = {};
  int count = 0;
  for (int v = 0; v < window.side; v += kRows) {
    const I16s inside = row + static_cast<std::int16_t>(v) < side;
    for (int j = 0; j < window.side; j += kMedianLanes, count += kShortLanes) {
      const I16s value = loadSamples(window.samples + v * window.sample_stride + j, window.sample_stride);
      const I16s valid = inside & (column + static_cast<std::int16_t>(j) < side) & (value != kNoSample);
      const U16s decay = decayOf(colourDistance(window, v, j), weight.decay);
      const U16s of_value = productHigh(decay, U16s{} + weight.largest) & reinterpret_cast<U16s>(valid);
      low = (valid & (value < low)) ? value : low;
      high = (valid & (value > high)) ? value : high;
      total += of_value;
      store(value, values + count);
      store(of_value, weights + count);
    }
  }
  Samples samples{low[0], high[0], sumOf(total), count};
  for (int i = 1; i < kShortLanes; ++i) {
    samples.low = low[i] < samples.low ? low[i] : samples.low;
    samples.high = high[i] > samples.high ? high[i] : samples.high;
  }
  return samples;
}

/// Do the weights of the samples up to each limit reach half of the total?
inline void reachHalf(const std::int16_t* values, const std::uint16_t* weights, const Samples& samples,
                      const int (&limits)[3], bool (&reached)[3]) {
  U16s sums[3] = {};
  for (int i = 0; i < samples.count; i += kShortLanes) {
    const I16s value = load<I16s>(values + i);
    const U16s weight = load<U16s>(weights + i);
    for (int k = 0; k < 3; ++k) {
      sums[k] += reinterpret_cast<U16s>(value <= static_cast<std::int16_t>(limits[k])) & weight;
    }
  }
  for (int k = 0; k < 3; ++k) reached[k] = 2 * sumOf(sums[k]) >= samples.total;
}

/// Bisection, two steps per pass over the samples: no sorting. The median is in (below, above].
std::int16_t weightedMedian(const MedianWindow& window, const MedianWeight& weight, std::int16_t* values,
                            std::uint16_t* weights) {
  const Samples samples = gather(window, weight, values, weights);
  int below = samples.low - 1, above = samples.high;
  while (above - below > 1) {
    const int middle = (below + above) >> 1;
    const int limits[3] = {(below + middle) >> 1, middle, (middle + above) >> 1};
    bool reached[3];
    reachHalf(values, weights, samples, limits, reached);
    (reached[1] ? above : below) = middle;
    const int second = reached[1] ? 0 : 2;
    if (limits[second] > below && limits[second] < above) (reached[second] ? above : below) = limits[second];
  }
  return static_cast<std::int16_t>(above);
}

}  // namespace

const WeightedMedianKernels& weightedMedianKernels() {
  static const WeightedMedianKernels kernels = {weightedMedian};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
