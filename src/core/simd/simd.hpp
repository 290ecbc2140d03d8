// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

/// Instruction sets that the kernels are compiled for.
enum class SimdLevel { kBaseline = 0, kAvx2 = 1, kAvx512 = 2 };

/// The best level of this processor, or less: environment variable FDP_STEREO_SIMD = baseline | avx2 | avx512 and
/// limitSimdLevel() lower it, never raise it.
SimdLevel simdLevel();
/// Throws std::invalid_argument where FDP_STEREO_SIMD is none of these names.
void checkWantedSimdLevel();
/// For tests: no kernel above `level` from now on.
void limitSimdLevel(SimdLevel level);

/// Picks one of the compiled forms of a kernel table, e.g.
///   FDP_STEREO_SELECT(semiGlobalKernels)  ->  avx2::semiGlobalKernels() or baseline::semiGlobalKernels()
#ifdef FDP_STEREO_HAVE_X86_KERNELS
#define FDP_STEREO_SELECT(function)                                                   \
  (::fdp_stereo::simdLevel() == ::fdp_stereo::SimdLevel::kAvx512 ? avx512::function() \
   : ::fdp_stereo::simdLevel() == ::fdp_stereo::SimdLevel::kAvx2 ? avx2::function()   \
                                                                 : baseline::function())
#define FDP_STEREO_DECLARE_KERNELS(Table, function) \
  namespace baseline {                              \
  const Table& function();                          \
  }                                                 \
  namespace avx2 {                                  \
  const Table& function();                          \
  }                                                 \
  namespace avx512 {                                \
  const Table& function();                          \
  }
#else
#define FDP_STEREO_SELECT(function) baseline::function()
#define FDP_STEREO_DECLARE_KERNELS(Table, function) \
  namespace baseline {                              \
  const Table& function();                          \
  }
#endif

}  // namespace fdp_stereo
