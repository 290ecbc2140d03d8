// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/cost_volume.hpp"

#include <stdexcept>
#include <string>

namespace fdp_stereo {

void CostVolume::create(int height, int width, DisparityRange range, Depth depth, float step, int max_raw) {
  create(height, width, range, depth, step, max_raw, {});
}

void CostVolume::create(int height, int width, DisparityRange range, Depth depth, float step, int max_raw,
                        const SearchTiles& tiles) {
  if (height <= 0 || width <= 0 || range.count <= 0) {
    throw std::invalid_argument("cost volume of " + std::to_string(width) + " x " + std::to_string(height) + " x " +
                                std::to_string(range.count) + ": every size must be at least 1");
  }
  height_ = height;
  width_ = width;
  range_ = range;
  depth_ = depth;
  step_ = step;
  max_raw_ = max_raw;
  stride_ = (range.count + kPadding - 1) / kPadding * kPadding;
  layOut(tiles);
  data_.reserve(bytes());
}

/// Row by row, so that paths along rows read on and paths along columns keep one step inside a tile.
void CostVolume::layOut(const SearchTiles& tiles) {
  constexpr int kWhole = 30;  // a shift beyond every size
  const bool whole = tiles.spans.empty();
  row_shift_ = whole ? kWhole : SearchTiles::kRowShift;
  column_shift_ = whole ? kWhole : SearchTiles::kColumnShift;
  across_ = whole ? 1 : SearchTiles::across(width_);
  tiles_.clear();
  row_entries_.clear();
  entries_ = 0;
  for (int top = 0; top < height_; top = tileBottom(top)) {
    std::size_t in_row = 0;
    for (int left = 0; left < width_; left = tileRight(left)) {
      const SearchTiles::Span span = whole ? SearchTiles::Span{0, stride_} : tiles.spans[tiles_.size()];
      tiles_.push_back({span, entries_ + in_row});
      in_row += static_cast<std::size_t>(tileRight(left) - left) * span.count;
    }
    row_entries_.push_back(in_row);
    entries_ += (tileBottom(top) - top) * in_row;
  }
}

std::size_t CostVolume::bytes() const { return entries_ * (depth_ == Depth::kU8 ? 1 : 2); }

void CostVolume::setRaw(int y, int x, int index, int value) {
  if (depth_ == Depth::kU8) {
    at<std::uint8_t>(y, x)[index] = static_cast<std::uint8_t>(value);
  } else {
    at<std::uint16_t>(y, x)[index] = static_cast<std::uint16_t>(value);
  }
}

void CostVolume::clearPadding() {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      for (int i = searched(span(y, x)); i < span(y, x).count; ++i) setRaw(y, x, i, max_raw_);
    }
  }
}

}  // namespace fdp_stereo
