// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "fdp_stereo/buffer.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Matching costs CM(x, y, d) of the left image, H x W x D, smaller is better (paper section 2.1.3).
///
/// Stored as unsigned integers of 8 or 16 bits in [y][x][d] order; cost = raw * step(). The d axis is padded to
/// a multiple of kPadding with maxRaw(), so that kernels may run over whole vectors and padding never wins.
/// No algorithm lives here.
class CostVolume {
 public:
  static constexpr int kPadding = 16;
  enum class Depth { kU8, kU16 };

  CostVolume() = default;
  /// Gives the volume a size; keeps its memory where that suffices. Contents are undefined afterwards, but for
  /// the padding, which is set by clearPadding(). Throws std::invalid_argument for an empty size.
  void create(int height, int width, DisparityRange range, Depth depth, float step, int max_raw);
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
  /// Number of raw entries from one pixel to the next: range().count rounded up to kPadding.
  int stride() const { return stride_; }
  std::size_t bytes() const;

  /// D raw costs of pixel (x, y), first entry is range().min. T must be the type of depth().
  template <typename T>
  T* at(int y, int x) {
    return data_.as<T>() + (static_cast<std::size_t>(y) * width_ + x) * stride_;
  }
  template <typename T>
  const T* at(int y, int x) const {
    return data_.as<T>() + (static_cast<std::size_t>(y) * width_ + x) * stride_;
  }

  /// Raw cost by disparity index (d - range().min); slow, for tests and rare look-ups.
  int raw(int y, int x, int index) const {
    return depth_ == Depth::kU8 ? at<std::uint8_t>(y, x)[index] : at<std::uint16_t>(y, x)[index];
  }
  void setRaw(int y, int x, int index, int value);
  float cost(int y, int x, int index) const { return static_cast<float>(raw(y, x, index)) * step_; }

 private:
  int height_ = 0;
  int width_ = 0;
  int stride_ = 0;
  int max_raw_ = 0;
  float step_ = 1.0F;
  DisparityRange range_;
  Depth depth_ = Depth::kU8;
  Buffer data_;
};

}  // namespace fdp_stereo
