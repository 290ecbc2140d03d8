// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/disparity_selection.hpp"

#include <algorithm>
#include <cstdlib>

namespace fdp_stereo {
namespace {

constexpr std::uint16_t kNone = 65535;

}  // namespace

DisparitySelection::DisparitySelection(const CostVolume& volume, SubpixelFit fit, double uniqueness_ratio, int paths)
    : volume_(volume),
      range_(volume.range()),
      width_(volume.width()),
      fit_(fit),
      uniqueness_ratio_(uniqueness_ratio),
      margin_unit_(volume.step() / static_cast<float>(paths)),
      cells_(width_),
      winners_(width_),
      right_best_(static_cast<std::size_t>(width_) + range_.count + std::abs(range_.min)),
      right_index_(right_best_.size()),
      left_(width_),
      right_(width_) {}

void DisparitySelection::createMaps(int height, int width, OptimizerOutput& output) {
  output.disparity_left.create(height, width, CV_32FC1);
  output.disparity_right.create(height, width, CV_32FC1);
  output.margin.create(height, width, CV_32FC1);
}

/// Of the left pixels, and of the right ones: left x at index i meets right pixel x - min - i, stored at
/// t = (width - 1 - x) + i + lead, so that t grows with i.
void DisparitySelection::findWinners(int y, const std::uint16_t* sums) {
  const SemiGlobalKernels& kernels = FDP_STEREO_SELECT(semiGlobalKernels);
  const int lead = std::max(range_.min, 0);
  std::fill(right_best_.begin(), right_best_.end(), kNone);
  for (int left = 0; left < width_; left = volume_.tileRight(left)) {
    const SearchTiles::Span span = volume_.span(y, left);
    const int right = volume_.tileRight(left), count = volume_.searched(span);
    kernels.findWinners(sums, span.count, count, right - left, &winners_[left]);
    for (int x = left; x < right; ++x, sums += span.count) {
      cells_[x] = {sums, span.first, count};
      auto& [best, index, second] = winners_[x];
      const std::uint16_t* at = sums + index;
      index = static_cast<std::uint16_t>(index + span.first);
      const int aside = cells_[x].inside(index) ? 1 : 0;
      left_.set(x, *(at - aside), best, *(at + aside));
      const std::ptrdiff_t t = width_ - 1 - x + lead + span.first;
      kernels.keepSmaller(sums, span.first, count, right_best_.data() + t, right_index_.data() + t);
    }
  }
}

void DisparitySelection::writeLeft(float* disparity, float* margin) {
  FDP_STEREO_SELECT(semiGlobalKernels)
      .subpixelOffsets(fit_, {left_.before.data(), left_.best.data(), left_.after.data()}, width_, left_.offset.data());
  for (int x = 0; x < width_; ++x) {
    const auto [best, index, second] = winners_[x];
    const bool unique = second != best && second * (100.0 - uniqueness_ratio_) >= best * 100.0;
    margin[x] = static_cast<float>(second - best) * margin_unit_;
    disparity[x] = unique ? static_cast<float>(range_.min + index) + left_.offset[x] : kInvalidDisparity;
  }
}

/// The costs of a right pixel at neighbouring disparities are those of neighbouring left pixels.
void DisparitySelection::writeRight(float* disparity) {
  const int last = width_ - 1 - range_.min + std::max(range_.min, 0);
  for (int x = 0; x < width_; ++x) {
    const int t = last - x, index = right_index_[t], left = x + range_.min + index;
    const bool seen = right_best_[t] != kNone;
    disparity[x] = seen ? static_cast<float>(range_.min + index) : kInvalidDisparity;
    const bool aside = seen && left > 0 && left + 1 < width_;
    const std::uint16_t* before = aside ? cells_[left - 1].at(index - 1) : nullptr;
    const std::uint16_t* after = aside ? cells_[left + 1].at(index + 1) : nullptr;
    const bool both = before != nullptr && after != nullptr;
    right_.set(x, both ? *before : right_best_[t], right_best_[t], both ? *after : right_best_[t]);
  }
  FDP_STEREO_SELECT(semiGlobalKernels)
      .subpixelOffsets(fit_, {right_.before.data(), right_.best.data(), right_.after.data()}, width_,
                       right_.offset.data());
  for (int x = 0; x < width_; ++x) disparity[x] += right_.offset[x];
}

void DisparitySelection::selectRow(int y, const std::uint16_t* sums, OptimizerOutput& output) {
  findWinners(y, sums);
  writeLeft(output.disparity_left.ptr<float>(y), output.margin.ptr<float>(y));
  writeRight(output.disparity_right.ptr<float>(y));
}

}  // namespace fdp_stereo
