// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/subpixel.hpp"
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {

/// Turns rows of summed costs into disparities of both views: the smallest cost, the lowest disparity on ties, a
/// sub-pixel fit and a uniqueness test for the left view. One instance per thread.
class DisparitySelection {
 public:
  DisparitySelection(SubpixelFit fit, double uniqueness_ratio) : fit_(fit), uniqueness_ratio_(uniqueness_ratio) {}

  /// Gives the output maps their size; call once, before the rows.
  static void createMaps(int height, int width, OptimizerOutput& output);

  /// sums: width x stride summed costs of row y.
  void selectRow(int y, const std::uint16_t* sums, int width, int stride, DisparityRange range,
                 OptimizerOutput& output);

 private:
  void writeLeft(int x, const Winner& winner, const std::uint16_t* sums, DisparityRange range, float* disparity,
                 float* confidence) const;
  void writeRight(int width, DisparityRange range, float* disparity) const;

  SubpixelFit fit_;
  double uniqueness_ratio_;
  std::vector<Winner> winners_;
  std::vector<std::uint16_t> right_best_;  // from right to left
  std::vector<std::uint16_t> right_index_;
};

}  // namespace fdp_stereo
