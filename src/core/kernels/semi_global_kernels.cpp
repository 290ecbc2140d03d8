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

/// One path of one disparity; all sums fit T by the choice of the cost step.
template <typename T>
inline T pathCost(const T* before, int i, T cost, T p1, T jump, T smallest) {
  const T aside = static_cast<T>(smaller(before[i - 1], before[i + 1]) + p1);
  return static_cast<T>(static_cast<T>(smaller(smaller(before[i], aside), jump) - smallest) + cost);
}

template <typename T, bool kAdd>
void stepTwo(PathStep<T>& step, int count, std::uint16_t* __restrict sums) {
  const T* __restrict costs = step.costs;
  const T* __restrict before0 = step.before[0];
  const T* __restrict before1 = step.before[1];
  T* __restrict after0 = step.after[0];
  T* __restrict after1 = step.after[1];
  T smallest0 = static_cast<T>(~T{0}), smallest1 = smallest0;
  const T p1 = step.p1;
  const T jump0 = step.jump[0], jump1 = step.jump[1];
  const T least0 = step.smallest_before[0], least1 = step.smallest_before[1];
#pragma omp simd reduction(min : smallest0, smallest1)
  for (int i = 0; i < count; ++i) {
    const T a = pathCost(before0, i, costs[i], p1, jump0, least0);
    const T b = pathCost(before1, i, costs[i], p1, jump1, least1);
    after0[i] = a;
    after1[i] = b;
    smallest0 = smaller(smallest0, a);
    smallest1 = smaller(smallest1, b);
    const std::uint16_t sum = static_cast<std::uint16_t>(a + b);
    sums[i] = kAdd ? static_cast<std::uint16_t>(sums[i] + sum) : sum;
  }
  step.smallest_after[0] = smallest0;
  step.smallest_after[1] = smallest1;
}

template <typename T, bool kAdd>
void stepFour(PathStep<T>& step, int count, std::uint16_t* __restrict sums) {
  const T* __restrict costs = step.costs;
  const T* __restrict before0 = step.before[0];
  const T* __restrict before1 = step.before[1];
  const T* __restrict before2 = step.before[2];
  const T* __restrict before3 = step.before[3];
  T* __restrict after0 = step.after[0];
  T* __restrict after1 = step.after[1];
  T* __restrict after2 = step.after[2];
  T* __restrict after3 = step.after[3];
  T smallest0 = static_cast<T>(~T{0}), smallest1 = smallest0, smallest2 = smallest0, smallest3 = smallest0;
  const T p1 = step.p1;
  const T jump0 = step.jump[0], jump1 = step.jump[1], jump2 = step.jump[2], jump3 = step.jump[3];
  const T least0 = step.smallest_before[0], least1 = step.smallest_before[1];
  const T least2 = step.smallest_before[2], least3 = step.smallest_before[3];
#pragma omp simd reduction(min : smallest0, smallest1, smallest2, smallest3)
  for (int i = 0; i < count; ++i) {
    const T a = pathCost(before0, i, costs[i], p1, jump0, least0);
    const T b = pathCost(before1, i, costs[i], p1, jump1, least1);
    const T c = pathCost(before2, i, costs[i], p1, jump2, least2);
    const T d = pathCost(before3, i, costs[i], p1, jump3, least3);
    after0[i] = a;
    after1[i] = b;
    after2[i] = c;
    after3[i] = d;
    smallest0 = smaller(smallest0, a);
    smallest1 = smaller(smallest1, b);
    smallest2 = smaller(smallest2, c);
    smallest3 = smaller(smallest3, d);
    const std::uint16_t sum = static_cast<std::uint16_t>(a + b + c + d);
    sums[i] = kAdd ? static_cast<std::uint16_t>(sums[i] + sum) : sum;
  }
  step.smallest_after[0] = smallest0;
  step.smallest_after[1] = smallest1;
  step.smallest_after[2] = smallest2;
  step.smallest_after[3] = smallest3;
}

template <typename T>
void step(PathStep<T>& paths_step, int paths, int count, bool add, std::uint16_t* sums) {
  if (paths == 2) {
    add ? stepTwo<T, true>(paths_step, count, sums) : stepTwo<T, false>(paths_step, count, sums);
  } else {
    add ? stepFour<T, true>(paths_step, count, sums) : stepFour<T, false>(paths_step, count, sums);
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
