// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/cost_volume.hpp"

#include <stdexcept>
#include <string>

namespace fdp_stereo {

void CostVolume::create(int height, int width, DisparityRange range, Depth depth, float step, int max_raw) {
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
  data_.reserve(bytes());
}

std::size_t CostVolume::bytes() const {
  return static_cast<std::size_t>(height_) * width_ * stride_ * (depth_ == Depth::kU8 ? 1 : 2);
}

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
      for (int i = range_.count; i < stride_; ++i) setRaw(y, x, i, max_raw_);
    }
  }
}

}  // namespace fdp_stereo
