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
  typedef std::uint16_t Total __attribute__((vector_size(kLanes * sizeof(std::uint16_t))));

  static Vector load(const T* from) {
    Vector v;
    __builtin_memcpy(&v, from, sizeof(v));
    return v;
  }
  static void store(const Vector& v, T* to) { __builtin_memcpy(to, &v, sizeof(v)); }
};

/// One pixel of one path.
template <typename T>
struct PathPixel {
  const T* before;
  T* after;
  const T* costs;
  T* excess;
  std::uint16_t* totals;
  T p1, jump, smallest;
};

template <typename Vector>
inline Vector smallerOf(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}

template <typename T>
using Half = typename Lanes<T, 16 / static_cast<int>(sizeof(T))>::Vector;
template <typename T>
using Full = typename Lanes<T, kVectorBytes / static_cast<int>(sizeof(T))>::Vector;

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

/// What one path adds to the costs of kLanes disparities from entry i on. All path costs fit T by the choice of the
/// cost step; only the sums of the first three paths may have to stop at the largest T.
template <typename T, int kLanes, PathSum kSum>
inline typename Lanes<T, kLanes>::Vector stepLanes(const PathPixel<T>& at, int i) {
  using L = Lanes<T, kLanes>;
  using Vector = typename L::Vector;
  using Total = typename L::Total;
  const T* before = at.before + i;
  const Vector aside = smallerOf(L::load(before - 1), L::load(before + 1)) + at.p1;
  const Vector excess = smallerOf(smallerOf(L::load(before), aside), Vector{} + at.jump) - at.smallest;
  const Vector cost = L::load(at.costs + i);
  const Vector path = excess + cost;
  L::store(path, at.after + i);
  if (kSum == PathSum::kFirst) {
    L::store(excess, at.excess + i);
  } else {
    const Vector others = L::load(at.excess + i);
    if (kSum == PathSum::kNext) L::store(others + smallerOf(excess, ~others), at.excess + i);
    if (kSum == PathSum::kLast) {
      const Total total = static_cast<std::uint16_t>(3) * __builtin_convertvector(cost, Total) +
                          __builtin_convertvector(others, Total) + __builtin_convertvector(path, Total);
      __builtin_memcpy(at.totals + i, &total, sizeof(total));
    }
  }
  return path;
}

/// One pixel of one line, all disparities; gives the smallest lanes.
template <typename T, PathSum kSum>
inline Half<T> stepPixel(const PathPixel<T>& at, int count) {
  constexpr int kWide = kVectorBytes / static_cast<int>(sizeof(T));
  constexpr int kNarrow = 16 / static_cast<int>(sizeof(T));
  Full<T> wide = ~Full<T>{};
  int i = 0;
  for (; i + kWide <= count; i += kWide) wide = smallerOf(wide, stepLanes<T, kWide, kSum>(at, i));
  Half<T> half = smallerHalf<T>(wide);
  for (; i < count; i += kNarrow) half = smallerOf(half, stepLanes<T, kNarrow, kSum>(at, i));
  return half;
}

template <typename T, int kLines, PathSum kSum>
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
      PathPixel<T> at{};
      at.before = before[k];
      at.after = after[k];
      at.costs = bundle.costs[k] + n * bundle.step;
      at.excess = bundle.excess[k] + n * bundle.sums_step;
      if (kSum == PathSum::kLast) at.totals = bundle.totals[k] + n * bundle.sums_step;
      at.p1 = bundle.p1;
      at.jump = static_cast<T>(smallest[k] + bundle.p2[k][n * bundle.p2_step]);
      at.smallest = smallest[k];
      half[k] = stepPixel<T, kSum>(at, bundle.count);
      T* const now = after[k];
      after[k] = before[k];
      before[k] = now;
    }
    smallestLanes<T>(half, smallest);
  }
  for (int k = 0; k < kLines; ++k) bundle.smallest[k] = smallest[k];
}

template <typename T, int kLines>
void followLines(const PathBundle<T>& bundle, PathSum sum) {
  switch (sum) {
    case PathSum::kFirst:
      return followOf<T, kLines, PathSum::kFirst>(bundle);
    case PathSum::kNext:
      return followOf<T, kLines, PathSum::kNext>(bundle);
    case PathSum::kLast:
      return followOf<T, kLines, PathSum::kLast>(bundle);
  }
}

template <typename T>
void follow(const PathBundle<T>& bundle, int lines, PathSum sum) {
  lines == kBundleLines ? followLines<T, kBundleLines>(bundle, sum) : followLines<T, 1>(bundle, sum);
}

// Sums less 2^15: SSE2 compares and finds minima of 16 bits with sign only.
using Signed = Full<std::int16_t>;
constexpr std::int16_t kNoSum = 32767;
constexpr int kSumLanes = kVectorBytes / 2;
static_assert(kSumLanes <= kSumsRead);

/// kSumLanes sums, kNoSum where the index is not below `count`.
inline Signed loadSums(const std::uint16_t* sums, const Signed& index, int count) {
  const Full<std::uint16_t> values = Lanes<std::uint16_t, kSumLanes>::load(sums) ^ static_cast<std::uint16_t>(1U << 15);
  return index < static_cast<std::int16_t>(count) ? reinterpret_cast<Signed>(values) : Signed{} + kNoSum;
}

inline std::uint16_t unsignedSum(std::int16_t sum) { return static_cast<std::uint16_t>(sum + (1 << 15)); }

/// The two smallest sums in each lane, and the index of the first of them.
struct LaneWinners {
  Signed best, index, second;
};

inline LaneWinners laneWinners(const std::uint16_t* sums, const Signed& first, int count) {
  LaneWinners lanes{Signed{} + kNoSum, Signed{} + kNoSum, Signed{} + kNoSum};
  Signed index = first;
  int i = 0;
  for (; i < count; i += kSumLanes, index += kSumLanes) {
    const Signed values = loadSums(sums + i, index, count);
    lanes.second = smallerOf(lanes.second, values < lanes.best ? lanes.best : values);
    lanes.index = values < lanes.best ? index : lanes.index;
    lanes.best = smallerOf(values, lanes.best);
  }
  return lanes;
}

/// Winners of four pixels, so that the lanes of all of them are reduced together. The winner and its two neighbours are
/// in three lanes, so that each lane's best but one of them tells the smallest sum elsewhere.
void findFourWinners(const std::uint16_t* const (&sums)[4], int count, Winner (&winners)[4]) {
  Signed first;
  for (int i = 0; i < kSumLanes; ++i) first[i] = static_cast<std::int16_t>(i);
  const Signed none = Signed{} + kNoSum;
  LaneWinners lanes[4];
  Half<std::int16_t> half[4];
  std::int16_t smallest[4], winner[4], second[4];
  for (int k = 0; k < 4; ++k) {
    lanes[k] = laneWinners(sums[k], first, count);
    half[k] = smallerHalf<std::int16_t>(lanes[k].best);
  }
  smallestLanes<std::int16_t>(half, smallest);
  for (int k = 0; k < 4; ++k) {
    half[k] = smallerHalf<std::int16_t>(lanes[k].best == smallest[k] ? lanes[k].index : none);
  }
  smallestLanes<std::int16_t>(half, winner);
  for (int k = 0; k < 4; ++k) {
    const Signed distance = lanes[k].index - winner[k];
    const Signed others = ((distance == -1) | (distance == 0) | (distance == 1)) ? lanes[k].second : lanes[k].best;
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

void keepSmaller(const std::uint16_t* __restrict values, int first, int count, std::uint16_t* __restrict best,
                 std::uint16_t* __restrict best_index) {
  for (int i = 0; i < count; ++i) {
    const bool better = values[i] < best[i];
    best_index[i] = better ? static_cast<std::uint16_t>(first + i) : best_index[i];
    best[i] = better ? values[i] : best[i];
  }
}

template <SubpixelFit kFit>
void subpixelOffsetsOf(const Minima& minima, int count, float* __restrict offsets) {
  const std::uint16_t* __restrict before = minima.before;
  const std::uint16_t* __restrict best = minima.best;
  const std::uint16_t* __restrict after = minima.after;
  for (int i = 0; i < count; ++i) offsets[i] = subpixelOffset(kFit, before[i], best[i], after[i]);
}

void subpixelOffsets(SubpixelFit fit, const Minima& minima, int count, float* offsets) {
  switch (fit) {
    case SubpixelFit::kNone:
      return subpixelOffsetsOf<SubpixelFit::kNone>(minima, count, offsets);
    case SubpixelFit::kParabola:
      return subpixelOffsetsOf<SubpixelFit::kParabola>(minima, count, offsets);
    case SubpixelFit::kEquiangular:
      return subpixelOffsetsOf<SubpixelFit::kEquiangular>(minima, count, offsets);
    case SubpixelFit::kBlended:
      return subpixelOffsetsOf<SubpixelFit::kBlended>(minima, count, offsets);
  }
}

}  // namespace

const SemiGlobalKernels& semiGlobalKernels() {
  static const SemiGlobalKernels kernels = {follow<std::uint8_t>, follow<std::uint16_t>, findWinners, keepSmaller,
                                            subpixelOffsets};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
