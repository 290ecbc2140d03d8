// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

// Vector types of the compiler, as wide as the registers: it would take wider ones apart lane by lane. The disparities
// of a pixel are a multiple of 16, so that no scalar remainder is left.
#ifdef __AVX2__
constexpr int kVectorBytes = 32;
#else
constexpr int kVectorBytes = 16;
#endif
typedef std::uint64_t U64x2 __attribute__((vector_size(16)));
typedef std::uint32_t U32x4 __attribute__((vector_size(16)));

template <typename T, int kLanes>
struct Lanes {
  typedef T Vector __attribute__((vector_size(kLanes * sizeof(T))));
  typedef std::uint16_t Sums __attribute__((vector_size(kLanes * sizeof(std::uint16_t))));

  static Vector load(const T* from) {
    Vector v;
    __builtin_memcpy(&v, from, sizeof(v));
    return v;
  }
  static void store(const Vector& v, T* to) { __builtin_memcpy(to, &v, sizeof(v)); }
};

template <typename Vector>
inline Vector smallerOf(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}

template <typename T>
using Half = typename Lanes<T, 16 / sizeof(T)>::Vector;
template <typename T>
using Full = typename Lanes<T, kVectorBytes / sizeof(T)>::Vector;

template <typename T>
inline Half<T> smallerHalf(const Full<T>& v) {
  Half<T> halves[2];
  __builtin_memcpy(&halves[0], &v, sizeof(halves[0]));
  if (kVectorBytes == 16) return halves[0];
  __builtin_memcpy(&halves[1], reinterpret_cast<const char*>(&v) + kVectorBytes - 16, sizeof(halves[1]));
  return smallerOf(halves[0], halves[1]);
}

#ifdef __clang__
#define FDP_STEREO_PICK(Mask, a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define FDP_STEREO_PICK(Mask, a, b, ...) __builtin_shuffle(a, b, Mask{__VA_ARGS__})
#endif

/// The smallest lanes of four vectors, by halving all of them together.
template <typename T>
inline void smallestLanes(const Half<T> (&v)[4], T (&smallest)[4]) {
  U64x2 pairs[2];
  for (int k = 0; k < 2; ++k) {
    const auto a = reinterpret_cast<U64x2>(v[2 * k]);
    const auto b = reinterpret_cast<U64x2>(v[2 * k + 1]);
    pairs[k] = reinterpret_cast<U64x2>(smallerOf(reinterpret_cast<Half<T>>(FDP_STEREO_PICK(U64x2, a, b, 0, 2)),
                                                 reinterpret_cast<Half<T>>(FDP_STEREO_PICK(U64x2, a, b, 1, 3))));
  }
  const auto a = reinterpret_cast<U32x4>(pairs[0]);
  const auto b = reinterpret_cast<U32x4>(pairs[1]);
  Half<T> all = smallerOf(reinterpret_cast<Half<T>>(FDP_STEREO_PICK(U32x4, a, b, 0, 2, 4, 6)),
                          reinterpret_cast<Half<T>>(FDP_STEREO_PICK(U32x4, a, b, 1, 3, 5, 7)));
  for (unsigned bits = 16; bits >= 8 * sizeof(T); bits /= 2) {
    all = smallerOf(all, reinterpret_cast<Half<T>>(reinterpret_cast<U32x4>(all) >> bits));
  }
  const auto lanes = reinterpret_cast<U32x4>(all);
  for (int k = 0; k < 4; ++k) smallest[k] = static_cast<T>(lanes[k]);
}

#undef FDP_STEREO_PICK

/// The paths that meet in one pixel.
template <typename T, int kPaths>
struct PixelPaths {
  const T* before[kPaths];
  T* after[kPaths];
  T smallest[kPaths];  // of the predecessors
  T jump[kPaths];      // that + P2
};

/// kLanes disparities of all paths of a pixel; all sums fit T by the choice of the cost step.
template <typename T, int kLanes, int kPaths, bool kAdd>
inline void stepLanes(const PixelPaths<T, kPaths>& paths, const T* costs, T p1, int i,
                      typename Lanes<T, kLanes>::Vector (&smallest)[4], std::uint16_t* sums) {
  using L = Lanes<T, kLanes>;
  using Vector = typename L::Vector;
  using Sums = typename L::Sums;
  const Vector cost = L::load(costs + i);
  Sums sum = {};
  if (kAdd) __builtin_memcpy(&sum, sums + i, sizeof(sum));
  for (int k = 0; k < kPaths; ++k) {
    const T* before = paths.before[k] + i;
    const Vector aside = smallerOf(L::load(before - 1), L::load(before + 1)) + p1;
    const Vector jump = Vector{} + paths.jump[k];
    const Vector path = smallerOf(smallerOf(L::load(before), aside), jump) - paths.smallest[k] + cost;
    L::store(path, paths.after[k] + i);
    smallest[k] = smallerOf(smallest[k], path);
    sum += __builtin_convertvector(path, Sums);
  }
  __builtin_memcpy(sums + i, &sum, sizeof(sum));
}

/// All disparities of a pixel; smallest[k] = the smallest cost of path k.
template <typename T, int kPaths, bool kAdd>
inline void stepPixel(const PixelPaths<T, kPaths>& paths, const T* costs, T p1, int count, std::uint16_t* sums,
                      T (&smallest)[4]) {
  constexpr int kWide = kVectorBytes / sizeof(T);
  Full<T> wide[4];
  for (auto& v : wide) v = ~Full<T>{};
  int i = 0;
  for (; i + kWide <= count; i += kWide) stepLanes<T, kWide, kPaths, kAdd>(paths, costs, p1, i, wide, sums);
  Half<T> half[4];
  for (int k = 0; k < 4; ++k) half[k] = smallerHalf<T>(wide[k]);
  if (i < count) stepLanes<T, 16 / sizeof(T), kPaths, kAdd>(paths, costs, p1, i, half, sums);
  smallestLanes<T>(half, smallest);
}

template <typename T, int kPaths, bool kAdd>
void sweepRowOf(const SweepRow<T>& row_in) {
  // A copy whose address nobody has: bytes stored through T* could otherwise change it, and it would be read anew.
  const SweepRow<T> row = row_in;
  T smallest[4] = {};
  PixelPaths<T, kPaths> paths;
  for (int n = 0; n < row.width; ++n) {
    const int x = row.backwards ? row.width - 1 - n : n;
    const std::ptrdiff_t slot = x * row.slot;
    const std::ptrdiff_t entry = static_cast<std::ptrdiff_t>(x) * row.count;
    paths.before[0] = row.along[(n & 1) ^ 1];
    paths.after[0] = row.along[n & 1];
    paths.smallest[0] = smallest[0];
    for (int k = 1; k < kPaths; ++k) {
      paths.before[k] = row.before[k] + slot;
      paths.after[k] = row.after[k] + slot;
      paths.smallest[k] = row.smallest_before[k][x];
    }
    for (int k = 0; k < kPaths; ++k) paths.jump[k] = static_cast<T>(paths.smallest[k] + row.p2[k][x]);
    stepPixel<T, kPaths, kAdd>(paths, row.costs + entry, row.p1, row.count, row.sums + entry, smallest);
    for (int k = 1; k < kPaths; ++k) row.smallest_after[k][x] = smallest[k];
  }
}

template <typename T>
void sweepRow(const SweepRow<T>& row, int paths, bool add) {
  if (paths == 2) {
    add ? sweepRowOf<T, 2, true>(row) : sweepRowOf<T, 2, false>(row);
  } else {
    add ? sweepRowOf<T, 4, true>(row) : sweepRowOf<T, 4, false>(row);
  }
}

// Sums less 2^15: SSE2 compares and finds minima of 16 bits with sign only.
using Signed = Full<std::int16_t>;
constexpr std::int16_t kNoSum = 32767;
constexpr int kSumLanes = kVectorBytes / 2;

/// kSumLanes sums, kNoSum where the index is not below `count`.
inline Signed loadSums(const std::uint16_t* sums, const Signed& index, int count) {
  const Full<std::uint16_t> values = Lanes<std::uint16_t, kSumLanes>::load(sums) ^ static_cast<std::uint16_t>(1U << 15);
  return index < static_cast<std::int16_t>(count) ? reinterpret_cast<Signed>(values) : Signed{} + kNoSum;
}

inline std::uint16_t unsignedSum(std::int16_t sum) { return static_cast<std::uint16_t>(sum + (1 << 15)); }

/// Winners of four pixels, so that the lanes of all of them are reduced together.
void findFourWinners(const std::uint16_t* const (&sums)[4], int count, Winner (&winners)[4]) {
  Signed first;
  for (int i = 0; i < kSumLanes; ++i) first[i] = static_cast<std::int16_t>(i);
  const Signed none = Signed{} + kNoSum;
  Signed best[4], best_index[4];
  Half<std::int16_t> half[4];
  std::int16_t smallest[4], winner[4], second[4];
  for (int k = 0; k < 4; ++k) {
    best[k] = best_index[k] = none;
    Signed index = first;
    for (int i = 0; i < count; i += kSumLanes, index += kSumLanes) {
      const Signed values = loadSums(sums[k] + i, index, count);
      best_index[k] = values < best[k] ? index : best_index[k];
      best[k] = smallerOf(values, best[k]);
    }
    half[k] = smallerHalf<std::int16_t>(best[k]);
  }
  smallestLanes<std::int16_t>(half, smallest);
  for (int k = 0; k < 4; ++k) half[k] = smallerHalf<std::int16_t>(best[k] == smallest[k] ? best_index[k] : none);
  smallestLanes<std::int16_t>(half, winner);
  for (int k = 0; k < 4; ++k) {
    Signed others = none;
    Signed index = first - winner[k];
    for (int i = 0; i < count; i += kSumLanes, index += kSumLanes) {
      const Signed values = loadSums(sums[k] + i, index, count - winner[k]);
      others = smallerOf(others, ((index == -1) | (index == 0) | (index == 1)) ? none : values);
    }
    half[k] = smallerHalf<std::int16_t>(others);
  }
  smallestLanes<std::int16_t>(half, second);
  for (int k = 0; k < 4; ++k) {
    winners[k] = {unsignedSum(smallest[k]), static_cast<std::uint16_t>(winner[k]), unsignedSum(second[k])};
  }
}

void findWinners(const std::uint16_t* sums, int stride, int count, int width, Winner* winners) {
  for (int x = 0; x < width; x += 4) {
    const std::uint16_t* four[4];
    for (int k = 0; k < 4; ++k) four[k] = sums + static_cast<std::ptrdiff_t>(x + k < width ? x + k : x) * stride;
    Winner found[4];
    findFourWinners(four, count, found);
    for (int k = 0; k < 4 && x + k < width; ++k) winners[x + k] = found[k];
  }
}

void keepSmaller(const std::uint16_t* __restrict values, int count, std::uint16_t* __restrict best,
                 std::uint16_t* __restrict best_index) {
  for (int i = 0; i < count; ++i) {
    const bool better = values[i] < best[i];
    best_index[i] = better ? static_cast<std::uint16_t>(i) : best_index[i];
    best[i] = better ? values[i] : best[i];
  }
}

}  // namespace

const SemiGlobalKernels& semiGlobalKernels() {
  static const SemiGlobalKernels kernels = {sweepRow<std::uint8_t>, sweepRow<std::uint16_t>, findWinners, keepSmaller};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
