// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/simd.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>

namespace fdp_stereo {
namespace {

constexpr std::array<const char*, 3> kLevelNames{"baseline", "avx2", "avx512"};

/// What FDP_STEREO_SIMD asks for: any level where it is not set; nothing where it is not the name of one.
std::optional<SimdLevel> wantedLevel() {
  const char* value = std::getenv("FDP_STEREO_SIMD");
  if (value == nullptr || *value == '\0') return SimdLevel::kAvx512;
  const auto name = std::find(kLevelNames.begin(), kLevelNames.end(), std::string(value));
  if (name == kLevelNames.end()) return std::nullopt;
  return static_cast<SimdLevel>(name - kLevelNames.begin());
}

SimdLevel supportedLevel() {
#ifdef FDP_STEREO_HAVE_X86_KERNELS
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512bitalg") &&
      __builtin_cpu_supports("avx512vpopcntdq")) {
    return SimdLevel::kAvx512;
  }
  return avx2 ? SimdLevel::kAvx2 : SimdLevel::kBaseline;
#else
  return SimdLevel::kBaseline;
#endif
}

std::atomic<SimdLevel> limit{SimdLevel::kAvx512};

}  // namespace

SimdLevel simdLevel() {
  static const SimdLevel detected = std::min(supportedLevel(), wantedLevel().value_or(SimdLevel::kAvx512));
  return std::min(detected, limit.load());
}

void checkWantedSimdLevel() {
  if (wantedLevel()) return;
  throw std::invalid_argument("environment variable FDP_STEREO_SIMD is '" +
                              std::string(std::getenv("FDP_STEREO_SIMD")) +
                              "': set it to baseline, avx2 or avx512, or not at all");
}

void limitSimdLevel(SimdLevel level) { limit = level; }

}  // namespace fdp_stereo
