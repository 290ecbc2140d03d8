// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/weighted_median_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

// Vectors of one register: comparisons of longer ones are taken apart into single numbers.
#if defined(__AVX2__)
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef std::int16_t Shorts __attribute__((vector_size(2 * kMedianLanes)));
typedef std::uint8_t Bytes __attribute__((vector_size(kMedianLanes)));

constexpr float kResolutionPx = 1.0F / 1024.0F;

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

inline std::int32_t sumOf(const Ints& v) {
  std::int32_t sum = 0;
  for (int i = 0; i < kLanes; ++i) sum += v[i];
  return sum;
}

/// What is known of the samples of a window.
struct Samples {
  float low, high;
  std::int32_t total;
  int count;
};

/// Weights of kMedianLanes pixels of row v from column j of the window on.
inline void storeWeights(const MedianWindow& window, int v, int j, std::int32_t* weights) {
  Shorts distance = {};
  for (int c = 0; c < window.channels; ++c) {
    const auto* pixels = window.planes[c] + v * window.plane_stride + j;
    const Shorts difference = __builtin_convertvector(load<Bytes>(pixels), Shorts) - window.colour[c];
    distance += difference < 0 ? -difference : difference;
  }
  std::int16_t index[kMedianLanes];
  store(distance, index);
  for (int i = 0; i < kMedianLanes; ++i) weights[i] = window.table[index[i]];
}

/// Fills values and weights; a neighbour without disparity, or right of the window, weighs nothing.
Samples gather(const MedianWindow& window, float* values, std::int32_t* weights) {
  Ints lane;
  for (int i = 0; i < kLanes; ++i) lane[i] = i;
  const Floats centre = Floats{} + window.centre;
  Floats low = centre, high = centre;
  Ints total = {};
  int count = 0;
  for (int v = 0; v < window.side; ++v) {
    for (int j = 0; j < window.side; j += kLanes, count += kLanes) {
      if (j % kMedianLanes == 0) storeWeights(window, v, j, weights + count);
      const Floats d = load<Floats>(window.disparity + v * window.disparity_stride + j);
      const Ints valid = (d == d) & (lane + j < window.side);
      const Floats value = valid ? d : centre;
      const Ints weight = load<Ints>(weights + count) & valid;
      low = value < low ? value : low;
      high = value > high ? value : high;
      total += weight;
      store(value, values + count);
      store(weight, weights + count);
    }
  }
  Samples samples{window.centre, window.centre, sumOf(total), count};
  for (int i = 0; i < kLanes; ++i) {
    samples.low = low[i] < samples.low ? low[i] : samples.low;
    samples.high = high[i] > samples.high ? high[i] : samples.high;
  }
  return samples;
}

/// Do the weights of the samples up to each limit reach half of the total?
inline void reachHalf(const float* values, const std::int32_t* weights, const Samples& samples,
                      const float (&limits)[3], bool (&reached)[3]) {
  Ints sums[3] = {};
  for (int i = 0; i < samples.count; i += kLanes) {
    const Floats value = load<Floats>(values + i);
    const Ints weight = load<Ints>(weights + i);
    for (int k = 0; k < 3; ++k) sums[k] += (value <= limits[k]) & weight;
  }
  for (int k = 0; k < 3; ++k) reached[k] = 2 * sumOf(sums[k]) >= samples.total;
}

/// The smallest sample in (below, above]; above if there is none.
inline float smallestIn(const float* values, const std::int32_t* weights, int count, float below, float above) {
  Floats smallest = Floats{} + above;
  for (int i = 0; i < count; i += kLanes) {
    const Floats value = load<Floats>(values + i);
    const Ints inside = (load<Ints>(weights + i) > 0) & (value > below) & (value < smallest);
    smallest = inside ? value : smallest;
  }
  float result = above;
  for (int i = 0; i < kLanes; ++i) result = smallest[i] < result ? smallest[i] : result;
  return result;
}

/// Narrows (low, high] around the median by bisection, two steps per pass over the samples: no sorting.
float weightedMedian(const MedianWindow& window, float* values, std::int32_t* weights) {
  const Samples samples = gather(window, values, weights);
  float below = samples.low, above = samples.high;
  bool reached[3];
  reachHalf(values, weights, samples, {below, below, below}, reached);
  if (reached[0]) return below;
  while (above - below >= kResolutionPx) {
    const float middle = 0.5F * (below + above);
    const float limits[3] = {0.5F * (below + middle), middle, 0.5F * (middle + above)};
    reachHalf(values, weights, samples, limits, reached);
    (reached[1] ? above : below) = middle;
    if (above - below < kResolutionPx) break;
    const int second = reached[1] ? 0 : 2;
    (reached[second] ? above : below) = limits[second];
  }
  return smallestIn(values, weights, samples.count, below, above);
}

}  // namespace

const WeightedMedianKernels& weightedMedianKernels() {
  static const WeightedMedianKernels kernels = {weightedMedian};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
