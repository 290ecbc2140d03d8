# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# fdp_stereo_add_kernels(target source...): compiles each kernel source once per instruction set, in a namespace of its
# own (FDP_STEREO_ISA), and leaves the choice to run time (src/core/simd/simd.hpp). A kernel source includes nothing but
# <cstdint>-like headers and intrinsics, which are always inlined: any other inline function compiled for AVX2 could be
# picked by the linker for everybody.
set(FDP_STEREO_OPTIMIZE $<$<NOT:$<CONFIG:Debug>>:-O3>)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(FDP_STEREO_ISAS baseline avx2 avx512)
  set(FDP_STEREO_FLAGS_baseline "")
  set(FDP_STEREO_FLAGS_avx2 -mavx2 -mpopcnt -mbmi -mbmi2)
  set(FDP_STEREO_FLAGS_avx512 -mavx512f -mavx512bw -mavx512vl -mavx512dq -mavx512cd -mavx512vbmi -mavx512bitalg
      -mavx512vpopcntdq -mprefer-vector-width=256 -mpopcnt -mbmi -mbmi2)
else()
  set(FDP_STEREO_ISAS baseline)
  set(FDP_STEREO_FLAGS_baseline "")
endif()

function(fdp_stereo_add_kernels target)
  foreach(isa IN LISTS FDP_STEREO_ISAS)
    set(object ${target}_kernels_${isa})
    add_library(${object} OBJECT ${ARGN})
    target_include_directories(${object} PRIVATE ${PROJECT_SOURCE_DIR}/src/core ${PROJECT_SOURCE_DIR}/include)
    # No trapping: a loop with a condition on floats becomes vectors only where both sides may be computed. Same bits.
    target_compile_options(${object} PRIVATE ${FDP_STEREO_OPTIMIZE} -ffp-contract=off -fno-trapping-math -fopenmp-simd -Wno-psabi
      ${FDP_STEREO_FLAGS_${isa}})
    target_compile_definitions(${object} PRIVATE FDP_STEREO_ISA=${isa})
    set_target_properties(${object} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${object}>)
  endforeach()
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
    target_compile_definitions(${target} PRIVATE FDP_STEREO_HAVE_X86_KERNELS)
  endif()
endfunction()
