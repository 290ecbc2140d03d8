// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Finds the seeds around a seed. Keeps a reference to the seeds.
class SeedGrid {
 public:
  struct Neighbour {
    int index = 0;
    float distance_px = 0.0F;
  };

  SeedGrid(const Seeds& seeds, cv::Size image);
  /// At most `count` nearest other seeds, nearest first, equal distances by index; searched up to two cells away, where
  /// a cell holds about three seeds. May be fewer in thin neighbourhoods.
  std::vector<Neighbour> nearest(int seed, int count) const;

 private:
  int cellOf(float position, int cells) const;

  const Seeds& seeds_;
  float cell_px_ = 1.0F;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<int> begin_;  // first entry of each cell in order_
  std::vector<int> order_;
};

}  // namespace fdp_stereo
