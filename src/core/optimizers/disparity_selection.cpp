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
    : range_(volume.range()),
      width_(volume.width()),
      stride_(volume.stride()),
      fit_(fit),
      uniqueness_ratio_(uniqueness_ratio),
      margin_unit_(volume.step() / static_cast<float>(paths)),
      winners_(width_),
      right_best_(static_cast<std::size_t>(width_) + range_.count + std::abs(range_.min)),
      right_index_(right_best_.size()) {}

void DisparitySelection::createMaps(int height, int width, OptimizerOutput& output) {
  output.disparity_left.create(height, width, CV_32FC1);
  output.disparity_right.create(height, width, CV_32FC1);
  output.margin.create(height, width, CV_32FC1);
}

float DisparitySelection::fraction(std::uint16_t before, std::uint16_t best, std::uint16_t after) const {
  return subpixelOffset(fit_, before, best, after);
}

void DisparitySelection::writeLeft(int x, const Winner& winner, const std::uint16_t* sums, float* disparity,
                                   float* margin) const {
  const int index = winner.index;
  margin[x] = static_cast<float>(winner.second - winner.best) * margin_unit_;
  const bool unique = winner.second * (100.0 - uniqueness_ratio_) >= winner.best * 100.0;
  if (winner.second == winner.best || !unique) {
    disparity[x] = kInvalidDisparity;
    return;
  }
  disparity[x] = static_cast<float>(range_.min + index);
  if (index > 0 && index + 1 < range_.count) disparity[x] += fraction(sums[index - 1], winner.best, sums[index + 1]);
}

/// The costs of a right pixel at neighbouring disparities are those of neighbouring left pixels.
void DisparitySelection::writeRight(const std::uint16_t* sums, float* disparity) const {
  for (int x = 0; x < width_; ++x) {
    const int t = width_ - 1 - x - range_.min + std::max(range_.min, 0);
    if (right_best_[t] == kNone) {
      disparity[x] = kInvalidDisparity;
      continue;
    }
    const int index = right_index_[t], left = x + range_.min + index;
    disparity[x] = static_cast<float>(range_.min + index);
    if (index > 0 && index + 1 < range_.count && left > 0 && left + 1 < width_) {
      const std::uint16_t* best = sums + static_cast<std::ptrdiff_t>(left) * stride_ + index;
      disparity[x] += fraction(best[-stride_ - 1], *best, best[stride_ + 1]);
    }
  }
}

void DisparitySelection::selectRow(int y, const std::uint16_t* sums, OptimizerOutput& output) {
  const SemiGlobalKernels& kernels = FDP_STEREO_SELECT(semiGlobalKernels);
  auto* disparity = output.disparity_left.ptr<float>(y);
  auto* margin = output.margin.ptr<float>(y);
  // Left x at index i meets right pixel x - min - i, stored at t = (width - 1 - x) + i + lead, so that t grows with i.
  const int lead = std::max(range_.min, 0);
  std::fill(right_best_.begin(), right_best_.end(), kNone);
  kernels.findWinners(sums, stride_, range_.count, width_, winners_.data());
  for (int x = 0; x < width_; ++x) {
    const std::uint16_t* costs = sums + static_cast<std::ptrdiff_t>(x) * stride_;
    writeLeft(x, winners_[x], costs, disparity, margin);
    kernels.keepSmaller(costs, range_.count, right_best_.data() + (width_ - 1 - x) + lead,
                        right_index_.data() + (width_ - 1 - x) + lead);
  }
  writeRight(sums, output.disparity_right.ptr<float>(y));
}

}  // namespace fdp_stereo
