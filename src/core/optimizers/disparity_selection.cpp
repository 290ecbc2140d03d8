// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/disparity_selection.hpp"

#include <algorithm>

namespace fdp_stereo {

void DisparitySelection::createMaps(int height, int width, OptimizerOutput& output) {
  output.disparity_left.create(height, width, CV_32FC1);
  output.disparity_right.create(height, width, CV_32FC1);
  output.confidence.create(height, width, CV_32FC1);
}

void DisparitySelection::writeLeft(int x, const Winner& winner, const std::uint16_t* sums, DisparityRange range,
                                   float* disparity, float* confidence) const {
  const int index = winner.index;
  confidence[x] = 1.0F - (winner.best + 1.0F) / (winner.second + 1.0F);
  disparity[x] = static_cast<float>(range.min + index);
  if (index > 0 && index + 1 < range.count) {
    disparity[x] += subpixelOffset(fit_, sums[index - 1], winner.best, sums[index + 1]);
  }
  if (winner.second * (100.0 - uniqueness_ratio_) < winner.best * 100.0) disparity[x] = kInvalidDisparity;
}

void DisparitySelection::writeRight(int width, DisparityRange range, float* disparity) const {
  for (int x = 0; x < width; ++x) {
    const std::size_t t = static_cast<std::size_t>(width - 1 - x - range.min + std::max(range.min, 0));
    disparity[x] = right_best_[t] == 65535 ? kInvalidDisparity : static_cast<float>(range.min + right_index_[t]);
  }
}

void DisparitySelection::selectRow(int y, const std::uint16_t* sums, int width, int stride, DisparityRange range,
                                   OptimizerOutput& output) {
  const SemiGlobalKernels& kernels = FDP_STEREO_SELECT(semiGlobalKernels);
  auto* disparity = output.disparity_left.ptr<float>(y);
  auto* confidence = output.confidence.ptr<float>(y);
  // Left x at index i meets right pixel x - min - i, stored at t = (width - 1 - x) + i + lead, so that t grows with i.
  const int lead = std::max(range.min, 0);
  const std::size_t length = static_cast<std::size_t>(width) + range.count + lead + std::max(-range.min, 0);
  right_best_.assign(length, 65535);
  right_index_.assign(length, 0);
  winners_.resize(width);
  kernels.findWinners(sums, stride, range.count, width, winners_.data());
  for (int x = 0; x < width; ++x) {
    const std::uint16_t* costs = sums + static_cast<std::size_t>(x) * stride;
    writeLeft(x, winners_[x], costs, range, disparity, confidence);
    kernels.keepSmaller(costs, range.count, right_best_.data() + (width - 1 - x) + lead,
                        right_index_.data() + (width - 1 - x) + lead);
  }
  writeRight(width, range, output.disparity_right.ptr<float>(y));
}

}  // namespace fdp_stereo
