// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fdp_stereo/buffer.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// The disparities that are searched in each tile of kRows x kColumns pixels, row by row: indices into the range of the
/// volume, each count a multiple of CostVolume::kPadding. No spans: all disparities everywhere.
struct SearchTiles {
  static constexpr int kRowShift = 4, kColumnShift = 5;
  static constexpr int kRows = 1 << kRowShift, kColumns = 1 << kColumnShift;
  struct Span {
    int first = 0;
    int count = 0;
  };

  static int across(int width) { return (width + kColumns - 1) / kColumns; }
  static int down(int height) { return (height + kRows - 1) / kRows; }

  std::vector<Span> spans;
};

/// Matching costs CM(x, y, d) of the left image, H x W x D, smaller is better (paper section 2.1.3).
///
/// Stored as unsigned integers of 8 or 16 bits in [y][x][d] order; cost = raw * step(). The d axis is padded to
/// a multiple of kPadding with maxRaw(), so that kernels may run over whole vectors and padding never wins.
/// A volume of search tiles holds their disparities only; any other one is a single tile. No algorithm lives here.
class CostVolume {
 public:
  static constexpr int kPadding = 16;
  enum class Depth { kU8, kU16 };

  CostVolume() = default;
  /// Gives the volume a size; keeps its memory where that suffices. Contents are undefined afterwards, but for
  /// the padding, which is set by clearPadding(). Throws std::invalid_argument for an empty size.
  void create(int height, int width, DisparityRange range, Depth depth, float step, int max_raw);
  /// The same, of the disparities in `tiles` only.
  void create(int height, int width, DisparityRange range, Depth depth, float step, int max_raw,
              const SearchTiles& tiles);
  /// Writes max_raw into the padding of every pixel.
  void clearPadding();

  bool empty() const { return height_ == 0; }
  int height() const { return height_; }
  int width() const { return width_; }
  DisparityRange range() const { return range_; }
  Depth depth() const { return depth_; }
  /// Cost of one raw unit.
  float step() const { return step_; }
  /// The largest raw cost that a stage may write.
  int maxRaw() const { return max_raw_; }
  /// range().count rounded up to kPadding: the number of raw entries of a pixel where all disparities are searched.
  int stride() const { return stride_; }
  std::size_t bytes() const;

  /// Does every pixel have all disparities?
  bool whole() const { return tiles_.size() == 1; }
  /// The raw entries of pixel (x, y) as indices of disparities; its neighbours in the tile have the same.
  SearchTiles::Span span(int y, int x) const { return tile(y, x).span; }
  /// Those of them that are disparities: not padding.
  int searched(SearchTiles::Span span) const { return std::min(span.count, range_.count - span.first); }
  /// The first column of the tile of column x and the first beyond it; the same of rows.
  int tileLeft(int x) const { return x >> column_shift_ << column_shift_; }
  int tileRight(int x) const { return std::min(((x >> column_shift_) + 1) << column_shift_, width_); }
  int tileTop(int y) const { return y >> row_shift_ << row_shift_; }
  int tileBottom(int y) const { return std::min(((y >> row_shift_) + 1) << row_shift_, height_); }
  /// Raw entries of row y, and those before pixel (x, y).
  std::size_t rowEntries(int y) const { return row_entries_[y >> row_shift_]; }
  std::size_t offset(int y, int x) const {
    const Tile& of = tile(y, x);
    return of.offset + (y & ((1 << row_shift_) - 1)) * rowEntries(y) +
           static_cast<std::size_t>(x & ((1 << column_shift_) - 1)) * of.span.count;
  }

  /// Raw costs of pixel (x, y), by default D of them from range().min on. T must be the type of depth().
  template <typename T>
  T* at(int y, int x) {
    return data_.as<T>() + offset(y, x);
  }
  template <typename T>
  const T* at(int y, int x) const {
    return data_.as<T>() + offset(y, x);
  }

  /// Raw cost by index into the span (d - range().min in a whole volume); slow, for tests and rare look-ups.
  int raw(int y, int x, int index) const {
    return depth_ == Depth::kU8 ? at<std::uint8_t>(y, x)[index] : at<std::uint16_t>(y, x)[index];
  }
  void setRaw(int y, int x, int index, int value);
  float cost(int y, int x, int index) const { return static_cast<float>(raw(y, x, index)) * step_; }

 private:
  struct Tile {
    SearchTiles::Span span;
    std::size_t offset = 0;  ///< of its first pixel
  };

  const Tile& tile(int y, int x) const {
    return tiles_[static_cast<std::size_t>(y >> row_shift_) * across_ + (x >> column_shift_)];
  }
  void layOut(const SearchTiles& tiles);

  int height_ = 0;
  int width_ = 0;
  int stride_ = 0;
  int max_raw_ = 0;
  float step_ = 1.0F;
  DisparityRange range_;
  Depth depth_ = Depth::kU8;
  int row_shift_ = 0, column_shift_ = 0;  // of the size of a tile
  int across_ = 0;                        // tiles in a row
  std::vector<Tile> tiles_;
  std::vector<std::size_t> row_entries_;  // by row of tiles
  std::size_t entries_ = 0;
  Buffer data_;
};

}  // namespace fdp_stereo
