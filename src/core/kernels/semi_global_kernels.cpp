// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <typename T>
inline T smaller(T a, T b) {
  return a < b ? a : b;
}

// Vector types of the compiler, of a fixed width on every instruction set: the disparities of a pixel are a multiple of
// 16, so that no scalar remainder is left.
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
  static Vector smallerOf(const Vector& a, const Vector& b) { return a < b ? a : b; }
  static T smallestOf(const Vector& v) {
    T lanes[kLanes];
    store(v, lanes);
    T result = lanes[0];
    for (int i = 1; i < kLanes; ++i) result = smaller(result, lanes[i]);
    return result;
  }
};

/// kLanes disparities of all paths of a pixel; all sums fit T by the choice of the cost step.
template <typename T, int kLanes, int kPaths, bool kAdd>
inline void stepLanes(const PathStep<T>& step, int i, typename Lanes<T, kLanes>::Vector (&smallest)[kPaths],
                      std::uint16_t* sums) {
  using L = Lanes<T, kLanes>;
  using Vector = typename L::Vector;
  using Sums = typename L::Sums;
  const Vector cost = L::load(step.costs + i);
  Sums sum = {};
  if (kAdd) __builtin_memcpy(&sum, sums + i, sizeof(sum));
  for (int k = 0; k < kPaths; ++k) {
    const T* before = step.before[k] + i;
    const Vector aside = L::smallerOf(L::load(before - 1), L::load(before + 1)) + step.p1;
    const Vector jump = Vector{} + step.jump[k];
    const Vector path = L::smallerOf(L::smallerOf(L::load(before), aside), jump) - step.smallest_before[k] + cost;
    L::store(path, step.after[k] + i);
    smallest[k] = L::smallerOf(smallest[k], path);
    sum += __builtin_convertvector(path, Sums);
  }
  __builtin_memcpy(sums + i, &sum, sizeof(sum));
}

template <typename T, int kPaths, bool kAdd>
void stepPaths(PathStep<T>& paths_step, int count, std::uint16_t* sums) {
  // A copy whose address nobody has: bytes stored through T* could otherwise change it, and it would be read anew.
  const PathStep<T> step = paths_step;
  constexpr int kWide = 32 / sizeof(T);
  constexpr int kNarrow = 16;
  typename Lanes<T, kWide>::Vector smallest[kPaths];
  typename Lanes<T, kNarrow>::Vector smallest_end[kPaths];
  for (int k = 0; k < kPaths; ++k) {
    smallest[k] = ~typename Lanes<T, kWide>::Vector{};
    smallest_end[k] = ~typename Lanes<T, kNarrow>::Vector{};
  }
  int i = 0;
  for (; i + kWide <= count; i += kWide) stepLanes<T, kWide, kPaths, kAdd>(step, i, smallest, sums);
  for (; i < count; i += kNarrow) stepLanes<T, kNarrow, kPaths, kAdd>(step, i, smallest_end, sums);
  for (int k = 0; k < kPaths; ++k) {
    paths_step.smallest_after[k] =
        smaller(Lanes<T, kWide>::smallestOf(smallest[k]), Lanes<T, kNarrow>::smallestOf(smallest_end[k]));
  }
}

template <typename T>
void step(PathStep<T>& paths_step, int paths, int count, bool add, std::uint16_t* sums) {
  if (paths == 2) {
    add ? stepPaths<T, 2, true>(paths_step, count, sums) : stepPaths<T, 2, false>(paths_step, count, sums);
  } else {
    add ? stepPaths<T, 4, true>(paths_step, count, sums) : stepPaths<T, 4, false>(paths_step, count, sums);
  }
}

std::uint16_t minimum(const std::uint16_t* values, int count) {
  std::uint16_t result = 65535;
  for (int i = 0; i < count; ++i) result = smaller(result, values[i]);
  return result;
}

int find(const std::uint16_t* values, int count, std::uint16_t value) {
  std::uint16_t first = static_cast<std::uint16_t>(count);
#pragma omp simd reduction(min : first)
  for (std::uint16_t i = 0; i < static_cast<std::uint16_t>(count); ++i) {
    const std::uint16_t index = values[i] == value ? i : std::uint16_t{65535};
    first = smaller(first, index);
  }
  return first;
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
  static const SemiGlobalKernels kernels = {step<std::uint8_t>, step<std::uint16_t>, minimum, find, keepSmaller};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
