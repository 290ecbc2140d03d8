// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

/// One row of a convolution.
struct Convolution {
  const std::int16_t* const* rows;  ///< `row_count` rows of inputs, the channels of a pixel side by side
  int row_count;
  int inputs;                   ///< numbers from pixel to pixel
  int pairs;                    ///< of neighbouring inputs that meet a row of the filter
  const std::int16_t* weights;  ///< [row][pair][output][2]
  const std::int32_t* biases;   ///< [output]
  int outputs;                  ///< 8, 16, 24 or 32
};

/// A learned cost: see dissimilarities().
struct LearnedMix {
  std::uint16_t largest;  ///< raw cost of no likeness
  std::uint16_t share;    ///< of the learned cost, in 1/256
};

/// Inner loops of the learned cost, compiled per instruction set.
struct CostNetworkKernels {
  /// sums[x * outputs + o], x = 0 .. width - 1, in 32 bits.
  void (*convolve)(const Convolution& convolution, int width, std::int32_t* sums);
  /// x (3 - x^2) / 2 of x = sums / 2^(12 + shift), clamped to -1 to 1, in 1/1024.
  void (*activate)(const std::int32_t* sums, int count, int shift, std::int16_t* outputs);
  /// values[i] = 65535 * (1 - ((1 + a.b) / 2)^4) for descriptors of length 127 in `pairs` pairs, the left one at left,
  /// pair k of the right ones at right[2 * (k * stride + i)]. Up to the next multiple of 16 entries are read and
  /// written.
  void (*dissimilarities)(const std::int16_t* left, const std::int16_t* right, int pairs, int stride, int count,
                          std::uint16_t* values);
  /// costs[i] = (1 - share) * costs[i] + share * largest * values[i] / 65536, for `count` rounded up to a multiple
  /// of 16.
  void (*mixU8)(const std::uint16_t* values, LearnedMix mix, int count, std::uint8_t* costs);
  void (*mixU16)(const std::uint16_t* values, LearnedMix mix, int count, std::uint16_t* costs);
};
FDP_STEREO_DECLARE_KERNELS(CostNetworkKernels, costNetworkKernels)

}  // namespace fdp_stereo
