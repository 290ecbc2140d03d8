// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo::reference {

/// Paper algorithm 1 as written: for every pixel of the image, for every seed, is the pixel in the seed's window?
inline void propagateWindow(Seeds seeds, const cv::Mat& left, int window, double gamma, CostVolume& volume) {
  std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) {
    const double ay = std::nearbyint(a.y);
    const double by = std::nearbyint(b.y);
    return ay < by || (ay == by && std::nearbyint(a.x) < std::nearbyint(b.x));
  });
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      for (const Seed& seed : seeds) {
        const int sx = static_cast<int>(std::nearbyint(seed.x));
        const int sy = static_cast<int>(std::nearbyint(seed.y));
        const int d = static_cast<int>(std::round(seed.d));
        if (sx < 0 || sy < 0 || sx >= left.cols || sy >= left.rows) continue;
        if (d < volume.range().min || d > volume.range().max()) continue;
        if (std::abs(x - sx) > window / 2 || std::abs(y - sy) > window / 2) continue;
        int colours = 0;
        for (int c = 0; c < left.channels(); ++c) {
          colours += std::abs(static_cast<int>(left.ptr(sy)[left.channels() * sx + c]) -
                              static_cast<int>(left.ptr(y)[left.channels() * x + c]));
        }
        const double weight = std::exp(-colours / (left.channels() * gamma));
        const double factor = std::round((1.0 - weight) * 65536.0);
        const int index = d - volume.range().min;
        volume.setRaw(y, x, index,
                      static_cast<int>(std::floor((volume.raw(y, x, index) * factor + 32768.0) / 65536.0)));
      }
    }
  }
}

}  // namespace fdp_stereo::reference
