// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace fdp_stereo::local_expansion {

/// A cell of a layer and the region that its moves change: the 3 x 3 cells around it, clipped to the image.
struct Cell {
  cv::Rect core;
  cv::Rect region;
  int index = 0;  ///< within the layer
};

/// A tiling of the image with square cells. A strip narrower than half a cell at the right or lower end belongs to the
/// last cell.
class Layer {
 public:
  static constexpr int kGroups = 16;

  /// cell_px: side of a cell, at least 1.
  Layer(cv::Size image, int cell_px);
  const std::vector<Cell>& cells() const { return cells_; }
  /// Cells (i, j) with equal i mod 4 and j mod 4. Between the regions of two cells of one group lies at least a whole
  /// cell, so neither their pixels nor their pairs of neighbours touch: they can be moved at the same time.
  const std::vector<int>& group(int g) const { return groups_[g]; }

 private:
  std::vector<Cell> cells_;
  std::array<std::vector<int>, kGroups> groups_;
};

}  // namespace fdp_stereo::local_expansion
