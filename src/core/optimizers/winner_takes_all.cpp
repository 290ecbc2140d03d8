// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/winner_takes_all.hpp"

#include <algorithm>
#include <vector>

#include "optimizers/disparity_selection.hpp"
#include "parallel.hpp"
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace {

struct Scratch {
  DisparitySelection selection;
  std::vector<std::uint16_t> sums;
};

template <typename T>
void takeWinnersOf(const CostVolume& volume, const WinnerTakesAllParams& params, OptimizerOutput& output) {
  const std::size_t row = static_cast<std::size_t>(volume.width()) * volume.stride();
  const auto makeScratch = [&] {
    return Scratch{DisparitySelection(volume, params.subpixel, params.uniqueness_ratio, 1),
                   std::vector<std::uint16_t>(row + kSumsRead)};
  };
  parallelFor(volume.height(), makeScratch, [&](int y, Scratch& scratch) {
    const T* costs = volume.at<T>(y, 0);
    std::copy_n(costs, row, scratch.sums.begin());
    scratch.selection.selectRow(y, scratch.sums.data(), output);
  });
}

}  // namespace

void takeWinners(const CostVolume& volume, const WinnerTakesAllParams& params, OptimizerOutput& output) {
  DisparitySelection::createMaps(volume.height(), volume.width(), output);
  if (volume.depth() == CostVolume::Depth::kU8) {
    takeWinnersOf<std::uint8_t>(volume, params, output);
  } else {
    takeWinnersOf<std::uint16_t>(volume, params, output);
  }
}

}  // namespace fdp_stereo
