// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/simd.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <string>

namespace fdp_stereo {
namespace {

SimdLevel detect() {
#ifdef FDP_STEREO_HAVE_X86_KERNELS
  __builtin_cpu_init();
  SimdLevel best = SimdLevel::kBaseline;
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  if (avx2) best = SimdLevel::kAvx2;
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512bitalg") &&
      __builtin_cpu_supports("avx512vpopcntdq")) {
    best = SimdLevel::kAvx512;
  }
  const char* wish = std::getenv("FDP_STEREO_SIMD");
  if (wish != nullptr && std::string(wish) == "baseline") best = SimdLevel::kBaseline;
  if (wish != nullptr && std::string(wish) == "avx2") best = std::min(best, SimdLevel::kAvx2);
  return best;
#else
  return SimdLevel::kBaseline;
#endif
}

std::atomic<SimdLevel> limit{SimdLevel::kAvx512};

}  // namespace

SimdLevel simdLevel() {
  static const SimdLevel detected = detect();
  return std::min(detected, limit.load());
}

void limitSimdLevel(SimdLevel level) { limit = level; }

}  // namespace fdp_stereo
