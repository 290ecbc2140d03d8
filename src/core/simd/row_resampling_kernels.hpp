// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

constexpr int kResamplingTaps = 6;
constexpr int kResamplingBits = 14;

/// Inner loops of the vertical resampling: out[i] = sum of weights[k] * rows[k][i], weights in units of 2^-14.
struct RowResamplingKernels {
  void (*combine8)(const std::uint8_t* const* rows, const std::int32_t* weights, int count, std::uint8_t* out);
  void (*combine16)(const std::uint16_t* const* rows, const std::int32_t* weights, int count, std::uint16_t* out);
};

FDP_STEREO_DECLARE_KERNELS(RowResamplingKernels, rowResamplingKernels)

}  // namespace fdp_stereo
