// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/weighted_median_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

std::int32_t weightUpTo(const float* __restrict values, const std::int32_t* __restrict weights, int count,
                        float limit) {
  std::int32_t sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < count; ++i) sum += values[i] <= limit ? weights[i] : 0;
  return sum;
}

}  // namespace

const WeightedMedianKernels& weightedMedianKernels() {
  static const WeightedMedianKernels kernels = {weightUpTo};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
