// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "fdp_stereo/cost_volume.hpp"

namespace fdp_stereo {
namespace reference {

/// Volume of random raw costs from 0 to max_raw.
inline CostVolume randomVolume(int height, int width, DisparityRange range, CostVolume::Depth depth, int max_raw,
                               unsigned seed) {
  CostVolume volume;
  volume.create(height, width, range, depth, 2.0F / static_cast<float>(max_raw), max_raw);
  std::mt19937 random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int i = 0; i < range.count; ++i) volume.setRaw(y, x, i, static_cast<int>(random() % (max_raw + 1)));
    }
  }
  volume.clearPadding();
  return volume;
}

}  // namespace reference
}  // namespace fdp_stereo
