// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/quasi_dense.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

#include "arguments.hpp"
#include "fdp_stereo/left_right_check.hpp"
#include "fdp_stereo/speckle_filter.hpp"
#include "parallel.hpp"
#include "row_grid.hpp"

namespace fdp_stereo {
namespace {

constexpr int kMedianRadiusPx = 3;
constexpr double kMaxDifferencePx = 1.0;  // between the views, and between neighbours of one region
constexpr int kSpecklePx = 60;            // of the image: a row that is matched stands for row_step rows

// A seed reaches far, so one that is alone is not believed: of the 8 around it, so many must differ by no more than
// this.
constexpr int kMinAgreeing = 2;
constexpr float kMaxStepPx = 2.0F;

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

cv::Mat rowsOf(const cv::Mat& image, int row_step) {
  const RowGrid rows(image.rows, row_step);
  cv::Mat taken(rows.count, image.cols, image.type());
  for (int row = 0; row < rows.count; ++row) image.row(rows.imageRow(row)).copyTo(taken.row(row));
  return taken;
}

int rowsPerSeed(const QuasiDenseParams& params) { return std::max(1, params.spacing_px / params.row_step); }

/// The first of samples that lie `spacing` apart, inside `size`.
int firstOf(int spacing, int size) { return std::min(spacing / 2, size - 1); }

/// What becomes seeds: CV_32FC1, NaN = none.
cv::Mat sampleGrid(const cv::Mat& map, const QuasiDenseParams& params) {
  const int rows_per_seed = rowsPerSeed(params);
  const int first_row = firstOf(rows_per_seed, map.rows), first_x = firstOf(params.spacing_px, map.cols);
  cv::Mat grid((map.rows - 1 - first_row) / rows_per_seed + 1, (map.cols - 1 - first_x) / params.spacing_px + 1,
               CV_32FC1);
  parallelFor(grid.rows, [&](int row) {
    for (int column = 0; column < grid.cols; ++column) {
      grid.at<float>(row, column) =
          medianAround(map.ptr<float>(first_row + row * rows_per_seed), map.cols, first_x + column * params.spacing_px);
    }
  });
  return grid;
}

/// Number of the up to 8 samples around one that are alike.
int agreeing(const cv::Mat& grid, int row, int column) {
  const float d = grid.at<float>(row, column);
  int count = -1;  // itself
  for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(grid.cols - 1, column + 1); ++c) {
      count += std::abs(grid.at<float>(r, c) - d) <= kMaxStepPx ? 1 : 0;
    }
  }
  return count;
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

RoughDisparity matchRoughly(const CostVolume& volume, const cv::Mat& guide, const QuasiDenseParams& params,
                            const SemiGlobalParams& penalties, SemiGlobalMatcher& matcher) {
  if (params.row_step < 1 || params.spacing_px < 1) {
    throw std::invalid_argument("quasi-dense seeds: row_step " + std::to_string(params.row_step) + " and spacing_px " +
                                std::to_string(params.spacing_px) + " must be at least 1");
  }
  OptimizerOutput output;
  if (volume.height() == guide.rows) {
    matcher.match(volume, guide, penalties, output, params.row_step);
  } else {
    matcher.match(volume, rowsOf(guide, params.row_step), penalties, output);
  }
  RoughDisparity rough{output.disparity_left, output.disparity_left.clone()};
  LeftRightCheckParams check;
  check.max_difference_px = kMaxDifferencePx;
  check.vote = false;
  checkLeftRight(rough.known, output.disparity_right, check);
  SpeckleFilterParams speckles;
  speckles.max_size = kSpecklePx / params.row_step;
  speckles.max_difference_px = kMaxDifferencePx;
  filterSpeckles(rough.known, speckles);
  return rough;
}

Seeds quasiDenseSeeds(const RoughDisparity& rough, cv::Size size, const QuasiDenseParams& params) {
  const cv::Mat grid = sampleGrid(rough.known, params);
  const RowGrid rows(size.height, params.row_step);
  const int rows_per_seed = rowsPerSeed(params);
  Seeds seeds;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.cols; ++column) {
      const float d = grid.at<float>(row, column);
      if (std::isnan(d) || agreeing(grid, row, column) < kMinAgreeing) continue;
      Seed seed;
      seed.x = static_cast<float>(firstOf(params.spacing_px, size.width) + column * params.spacing_px);
      seed.y = static_cast<float>(rows.imageRow(firstOf(rows_per_seed, rough.known.rows) + row * rows_per_seed));
      seed.d = d;
      seed.source = SeedSource::kQuasiDense;
      seeds.push_back(seed);
    }
  }
  return seeds;
}

}  // namespace fdp_stereo
