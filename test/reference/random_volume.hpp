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

/// The cells of some search tiles of a whole volume.
inline CostVolume searchedOf(const CostVolume& whole, const SearchTiles& tiles) {
  CostVolume volume;
  volume.create(whole.height(), whole.width(), whole.range(), whole.depth(), whole.step(), whole.maxRaw(), tiles);
  for (int y = 0; y < whole.height(); ++y) {
    for (int x = 0; x < whole.width(); ++x) {
      const SearchTiles::Span span = volume.span(y, x);
      for (int i = 0; i < volume.searched(span); ++i) volume.setRaw(y, x, i, whole.raw(y, x, span.first + i));
    }
  }
  volume.clearPadding();
  return volume;
}

/// Spans of 16 disparities or more, anywhere in the range.
inline SearchTiles randomTiles(cv::Size size, DisparityRange range, unsigned seed) {
  std::mt19937 random(seed);
  SearchTiles tiles;
  const int paddings = (range.count + CostVolume::kPadding - 1) / CostVolume::kPadding;
  tiles.spans.resize(static_cast<std::size_t>(SearchTiles::across(size.width)) * SearchTiles::down(size.height));
  for (SearchTiles::Span& span : tiles.spans) {
    span.count = CostVolume::kPadding * (1 + static_cast<int>(random() % paddings));
    span.first = static_cast<int>(random() % (std::max(0, range.count - span.count) + 1));
  }
  return tiles;
}

}  // namespace reference
}  // namespace fdp_stereo
