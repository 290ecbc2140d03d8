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

/// Turns rows of summed costs into disparities of both views: the smallest cost, a sub-pixel fit, and for the left view
/// a uniqueness test and the margin. Another disparity that is as good is no answer. One instance per thread.
class DisparitySelection {
 public:
  /// paths: how many costs were added up.
  DisparitySelection(const CostVolume& volume, SubpixelFit fit, double uniqueness_ratio, int paths);

  /// Gives the output maps their size; call once, before the rows.
  static void createMaps(int height, int width, OptimizerOutput& output);

  /// sums: width x stride summed costs of row y.
  void selectRow(int y, const std::uint16_t* sums, OptimizerOutput& output);

 private:
  void writeLeft(int x, const Winner& winner, const std::uint16_t* sums, float* disparity, float* margin) const;
  void writeRight(const std::uint16_t* sums, float* disparity) const;
  float fraction(std::uint16_t before, std::uint16_t best, std::uint16_t after) const;

  DisparityRange range_;
  int width_, stride_;
  SubpixelFit fit_;
  double uniqueness_ratio_;
  float margin_unit_;  // cost per path of one raw unit
  std::vector<Winner> winners_;
  std::vector<std::uint16_t> right_best_;  // from right to left
  std::vector<std::uint16_t> right_index_;
};

}  // namespace fdp_stereo
