// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

// Vector types of the compiler, as wide as the registers: it would take wider ones apart lane by lane. The disparities
// of a pixel are a multiple of 16, so that no scalar remainder is left.
#if defined(__AVX512BW__)
constexpr int kVectorBytes = 64;
#elif defined(__AVX2__)
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
  constexpr int kParts = kVectorBytes / 16;
  Half<T> parts[kParts];
  __builtin_memcpy(parts, &v, sizeof(v));
  for (int step = kParts / 2; step > 0; step /= 2) {
    for (int k = 0; k < step; ++k) parts[k] = smallerOf(parts[k], parts[k + step]);
  }
  return parts[0];
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

/// kLanes disparities of one pixel of each line from entry i on; all path costs fit T by the choice of the cost step.
template <typename T, int kLanes, bool kAdd>
inline typename Lanes<T, kLanes>::Vector stepLanes(const T* before, T* after, const T* costs, std::uint16_t* sums, T p1,
                                                   T jump, T smallest) {
  using L = Lanes<T, kLanes>;
  using Vector = typename L::Vector;
  using Sums = typename L::Sums;
  const Vector aside = smallerOf(L::load(before - 1), L::load(before + 1)) + p1;
  const Vector path = smallerOf(smallerOf(L::load(before), aside), Vector{} + jump) - smallest + L::load(costs);
  L::store(path, after);
  Sums sum = __builtin_convertvector(path, Sums);
  if (kAdd) {
    Sums others;
    __builtin_memcpy(&others, sums, sizeof(others));
    sum += others;
  }
  __builtin_memcpy(sums, &sum, sizeof(sum));
  return path;
}

/// One pixel of one line, all disparities; gives the smallest lanes.
template <typename T, bool kAdd>
inline Half<T> stepPixel(const T* before, T* after, const T* costs, std::uint16_t* sums, T p1, T jump, T smallest,
                         int count) {
  constexpr int kWide = kVectorBytes / sizeof(T);
  constexpr int kNarrow = 16 / sizeof(T);
  Full<T> wide = ~Full<T>{};
  int i = 0;
  for (; i + kWide <= count; i += kWide) {
    wide = smallerOf(wide, stepLanes<T, kWide, kAdd>(before + i, after + i, costs + i, sums + i, p1, jump, smallest));
  }
  Half<T> half = smallerHalf<T>(wide);
  for (; i < count; i += kNarrow) {
    half = smallerOf(half, stepLanes<T, kNarrow, kAdd>(before + i, after + i, costs + i, sums + i, p1, jump, smallest));
  }
  return half;
}

template <typename T, int kLines, bool kAdd>
void followOf(const PathBundle<T>& bundle_in) {
  // A copy whose address nobody has: bytes stored through T* could otherwise change it, and it would be read anew.
  const PathBundle<T> bundle = bundle_in;
  T* before[kLines];
  T* after[kLines];
  T smallest[4] = {};
  for (int k = 0; k < kLines; ++k) {
    before[k] = bundle.before[k];
    after[k] = bundle.after[k];
    smallest[k] = bundle.smallest[k];
  }
  for (int n = 0; n < bundle.length; ++n) {
    Half<T> half[4] = {};
    for (int k = 0; k < kLines; ++k) {
      const T jump = static_cast<T>(smallest[k] + bundle.p2[k][n * bundle.p2_step]);
      half[k] = stepPixel<T, kAdd>(before[k], after[k], bundle.costs[k] + n * bundle.step,
                                   bundle.sums[k] + n * bundle.sums_step, bundle.p1, jump, smallest[k], bundle.count);
      T* const now = after[k];
      after[k] = before[k];
      before[k] = now;
    }
    smallestLanes<T>(half, smallest);
  }
  for (int k = 0; k < kLines; ++k) bundle.smallest[k] = smallest[k];
}

template <typename T>
void follow(const PathBundle<T>& bundle, int lines, bool add) {
  if (lines == kBundleLines) {
    add ? followOf<T, kBundleLines, true>(bundle) : followOf<T, kBundleLines, false>(bundle);
  } else {
    add ? followOf<T, 1, true>(bundle) : followOf<T, 1, false>(bundle);
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
  static const SemiGlobalKernels kernels = {follow<std::uint8_t>, follow<std::uint16_t>, findWinners, keepSmaller};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
