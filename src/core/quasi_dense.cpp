// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/quasi_dense.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "fdp_stereo/left_right_check.hpp"
#include "fdp_stereo/speckle_filter.hpp"

namespace fdp_stereo {
namespace {

constexpr int kPaths = 4;
constexpr int kMedianRadiusPx = 3;
constexpr double kMaxDifferencePx = 1.0;  // between the views, and between neighbours of one region
constexpr int kSpecklePx = 60;            // of the image: a row that is matched stands for row_step rows

/// Median of the known disparities among those of the row around x; NaN where there are none.
float medianAround(const float* row, int width, int x) {
  std::array<float, 2 * kMedianRadiusPx + 1> known{};
  const auto end = std::copy_if(row + std::max(0, x - kMedianRadiusPx), row + std::min(width, x + kMedianRadiusPx + 1),
                                known.begin(), [](float d) { return !std::isnan(d); });
  if (end == known.begin()) return kInvalidDisparity;
  const auto middle = known.begin() + std::distance(known.begin(), end) / 2;
  std::nth_element(known.begin(), middle, end);
  return *middle;
}

}  // namespace

DisparityPropagationParams surfacesOf(const QuasiDenseParams& params) {
  DisparityPropagationParams surfaces;
  surfaces.form = PropagationForm::kSurface;
  surfaces.gamma = params.gamma;
  surfaces.reach_px = params.reach_px;
  surfaces.strength = params.strength;
  surfaces.spread_px = params.spread_px;
  return surfaces;
}

Seeds quasiDenseSeeds(const CostVolume& volume, const StereoPair& pair, const QuasiDenseParams& params,
                      SemiGlobal& semi_global) {
  OptimizerOutput rough;
  const Seeds none;
  semi_global.optimizeRows({volume, pair, none, nullptr, nullptr, {}, {}}, kPaths, params.row_step, rough);
  LeftRightCheckParams check;
  check.max_difference_px = kMaxDifferencePx;
  checkLeftRight(rough.disparity_left, rough.disparity_right, check);
  SpeckleFilterParams speckles;
  speckles.max_size = kSpecklePx / params.row_step;
  speckles.max_difference_px = kMaxDifferencePx;
  filterSpeckles(rough.disparity_left, speckles);

  const cv::Mat& map = rough.disparity_left;
  const int first_row = SemiGlobal::firstRow(volume.height(), params.row_step);
  const int rows_per_seed = std::max(1, params.spacing_px / params.row_step);
  Seeds seeds;
  for (int row = std::min(rows_per_seed / 2, map.rows - 1); row < map.rows; row += rows_per_seed) {
    for (int x = std::min(params.spacing_px / 2, map.cols - 1); x < map.cols; x += params.spacing_px) {
      Seed seed;
      seed.x = static_cast<float>(x);
      seed.y = static_cast<float>(first_row + row * params.row_step);
      seed.d = medianAround(map.ptr<float>(row), map.cols, x);
      seed.source = SeedSource::kQuasiDense;
      if (!std::isnan(seed.d)) seeds.push_back(seed);
    }
  }
  return seeds;
}

}  // namespace fdp_stereo
