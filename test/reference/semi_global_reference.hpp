// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/semi_global.hpp"

namespace fdp_stereo {
namespace reference {

constexpr int kNotSearched = 1 << 20;

/// Sum over the paths of L_r(p, d) = C + min(L(d), L(d -+ 1) + P1, min L + P2) - min L (Hirschmueller 2008, eq. 13), in
/// raw units, [(y * width + x) * count + d]; one path at a time, each pixel looked up anew from its predecessor.
inline std::vector<int> pathSums(const CostVolume& volume, const cv::Mat& grey, const SemiGlobalParams& params) {
  const int width = volume.width();
  const int height = volume.height();
  const int count = volume.range().count;
  const int p1 = static_cast<int>(std::lround(params.p1 / volume.step()));
  const auto at = [&](int x, int y) { return (static_cast<std::size_t>(y) * width + x) * count; };
  std::vector<int> sums(static_cast<std::size_t>(width) * height * count, 0);
  for (const cv::Point r : {cv::Point{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    std::vector<int> path(sums.size(), 0);
    for (int j = 0; j < height; ++j) {
      for (int i = 0; i < width; ++i) {
        const int x = r.x < 0 ? width - 1 - i : i;
        const int y = r.y < 0 ? height - 1 - j : j;
        const int x_before = x - r.x;
        const int y_before = y - r.y;
        const bool first = x_before < 0 || x_before >= width || y_before < 0 || y_before >= height;
        const int* before = first ? nullptr : &path[at(x_before, y_before)];
        const int smallest = first ? 0 : *std::min_element(before, before + count);
        int p2 = 0;
        if (!first) {
          const int difference = std::abs(grey.at<unsigned char>(y, x) - grey.at<unsigned char>(y_before, x_before));
          const double penalty = std::max(params.p1, params.p2 / (1.0 + params.p2_gradient * difference));
          p2 = static_cast<int>(std::lround(penalty / volume.step()));
        }
        for (int d = 0; d < count; ++d) {
          int best = 0;
          if (!first) {
            best = std::min(before[d], smallest + p2);
            if (d > 0) best = std::min(best, before[d - 1] + p1);
            if (d + 1 < count) best = std::min(best, before[d + 1] + p1);
          }
          const SearchTiles::Span span = volume.span(y, x);
          const bool searched = d >= span.first && d < span.first + span.count;
          path[at(x, y) + d] = searched ? volume.raw(y, x, d - span.first) + best - smallest : kNotSearched;
          sums[at(x, y) + d] += path[at(x, y) + d];
        }
      }
    }
  }
  return sums;
}

}  // namespace reference
}  // namespace fdp_stereo
