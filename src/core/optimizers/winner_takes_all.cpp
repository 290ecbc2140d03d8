// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/winner_takes_all.hpp"

#include <vector>

#include "optimizers/disparity_selection.hpp"

namespace fdp_stereo {
namespace {

template <typename T>
void optimizeVolume(const CostVolume& volume, const WinnerTakesAllParams& params, OptimizerOutput& output) {
#pragma omp parallel
  {
    DisparitySelection selection(params.subpixel, params.uniqueness_ratio);
    std::vector<std::uint16_t> sums(static_cast<std::size_t>(volume.width()) * volume.stride());
#pragma omp for schedule(static)
    for (int y = 0; y < volume.height(); ++y) {
      const T* costs = volume.at<T>(y, 0);
      sums.assign(costs, costs + sums.size());
      selection.selectRow(y, sums.data(), volume.width(), volume.stride(), volume.range(), output);
    }
  }
}

}  // namespace

void WinnerTakesAll::optimize(const OptimizerInput& input, OptimizerOutput& output) {
  DisparitySelection::createMaps(input.volume.height(), input.volume.width(), output);
  if (input.volume.depth() == CostVolume::Depth::kU8) {
    optimizeVolume<std::uint8_t>(input.volume, params_, output);
  } else {
    optimizeVolume<std::uint16_t>(input.volume, params_, output);
  }
}

}  // namespace fdp_stereo
