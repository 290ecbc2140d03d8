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

  /// sums: summed costs of row y, laid out as the volume.
  void selectRow(int y, const std::uint16_t* sums, OptimizerOutput& output);

 private:
  /// Sums around the minimum of each pixel of a row, and the offsets that follow; without neighbours both rise alike.
  struct Row {
    std::vector<std::uint16_t> before, best, after;
    std::vector<float> offset;

    explicit Row(std::size_t width) : before(width), best(width), after(width), offset(width) {}
    void set(int x, std::uint16_t of_before, std::uint16_t of_best, std::uint16_t of_after) {
      before[x] = of_before;
      best[x] = of_best;
      after[x] = of_after;
    }
  };

  /// Sums of a pixel, of so many disparities from an index on.
  struct Cells {
    const std::uint16_t* sums;
    int first, count;

    bool inside(int index) const { return index > first && index + 1 < first + count; }
    const std::uint16_t* at(int index) const {
      return index >= first && index < first + count ? sums + (index - first) : nullptr;
    }
  };

  void findWinners(int y, const std::uint16_t* sums);
  void writeLeft(float* disparity, float* margin);
  void writeRight(float* disparity);

  const CostVolume& volume_;
  DisparityRange range_;
  int width_;
  SubpixelFit fit_;
  double uniqueness_ratio_;
  float margin_unit_;  // cost per path of one raw unit
  std::vector<Cells> cells_;
  std::vector<Winner> winners_;
  std::vector<std::uint16_t> right_best_;  // from right to left
  std::vector<std::uint16_t> right_index_;
  Row left_, right_;
};

}  // namespace fdp_stereo
