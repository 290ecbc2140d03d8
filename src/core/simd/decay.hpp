// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace fdp_stereo {

/// exp(-v / lambda) of a fixed-point v in 16-bit integers: with y = min(v, limit) / (16 lambda) below 1/2, exp(-16 y)
/// is (1 - y + 0.475 y^2)^16, off by at most 6e-4.
struct Decay {
  std::uint16_t limit;  ///< beyond here nothing is left
  std::uint16_t shift;  ///< y = (v << shift) * factor / 2^32
  std::uint16_t factor;
};
constexpr std::uint16_t kDecayOne = 65520;     ///< exp(0): what four squarings leave of 65535
constexpr std::uint16_t kDecaySquare = 31130;  ///< 0.475 * 2^16

/// lambda > 0 in units of v.
Decay makeDecay(double lambda);

}  // namespace fdp_stereo
