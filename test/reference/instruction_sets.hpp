// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

#include <string>

#include "simd/simd.hpp"

namespace fdp_stereo {
namespace reference {

/// A test per instruction set that kernels are compiled for; skipped where the processor lacks it.
class EveryInstructionSet : public testing::TestWithParam<SimdLevel> {
 protected:
  void SetUp() override {
    if (simdLevel() < GetParam()) GTEST_SKIP() << "not on this processor, or not allowed by FDP_STEREO_SIMD";
  }
  void TearDown() override {
    limitSimdLevel(SimdLevel::kAvx512);
    omp_set_num_threads(omp_get_num_procs());
  }
  /// What f() gives with the baseline's kernels and one thread.
  template <typename F>
  static auto onBaseline(F f) {
    return limited(SimdLevel::kBaseline, 1, f);
  }
  /// What it gives with the kernels of this test and several threads.
  template <typename F>
  static auto onThisSet(F f) {
    return limited(GetParam(), 3, f);
  }

 private:
  template <typename F>
  static auto limited(SimdLevel level, int threads, F f) {
    limitSimdLevel(level);
    omp_set_num_threads(threads);
    return f();
  }
};

inline std::string instructionSetName(const testing::TestParamInfo<SimdLevel>& info) {
  return info.param == SimdLevel::kBaseline ? "baseline" : info.param == SimdLevel::kAvx2 ? "avx2" : "avx512";
}

}  // namespace reference
}  // namespace fdp_stereo

/// For test files that use reference::EveryInstructionSet.
#define FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(Suite)                                                  \
  INSTANTIATE_TEST_SUITE_P(Kernels, Suite,                                                              \
                           testing::Values(SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512), \
                           reference::instructionSetName)
