// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/decay.hpp"

#include <algorithm>
#include <cmath>

namespace fdp_stereo {

Decay makeDecay(double lambda) {
  Decay decay{};
  decay.limit = static_cast<std::uint16_t>(std::clamp(std::floor(8.0 * lambda), 1.0, 2047.0));
  while ((decay.limit << (decay.shift + 1)) <= 65535) ++decay.shift;
  const double factor = 65536.0 * 65536.0 / (16.0 * lambda * (1 << decay.shift));
  decay.factor = static_cast<std::uint16_t>(std::min(std::lround(factor), 65535L));
  return decay;
}

}  // namespace fdp_stereo
