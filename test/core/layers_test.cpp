// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/layers.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fdp_stereo::local_expansion {
namespace {

struct Tiling {
  int width, height, cell;
};

class LayerTilings : public testing::TestWithParam<Tiling> {};

TEST_P(LayerTilings, CellsCoverEveryPixelOnce) {
  const Tiling t = GetParam();
  const Layer layer({t.width, t.height}, t.cell);
  cv::Mat count = cv::Mat::zeros(t.height, t.width, CV_32S);
  for (const Cell& cell : layer.cells()) {
    count(cell.core) += 1;
    EXPECT_EQ(cell.core & cell.region, cell.core);
    EXPECT_LT(cell.core.width, t.cell + (t.cell + 1) / 2 + 1);
  }
  EXPECT_EQ(cv::countNonZero(count != 1), 0);
}

TEST_P(LayerTilings, RegionsOfAGroupDoNotTouch) {
  const Tiling t = GetParam();
  const Layer layer({t.width, t.height}, t.cell);
  std::size_t cells = 0;
  for (int g = 0; g < Layer::kGroups; ++g) {
    const std::vector<int>& group = layer.group(g);
    cells += group.size();
    for (std::size_t i = 0; i < group.size(); ++i) {
      cv::Rect grown = layer.cells()[group[i]].region;
      grown += cv::Size(2, 2);
      grown -= cv::Point(1, 1);
      for (std::size_t j = 0; j < group.size(); ++j) {
        if (i == j) continue;
        EXPECT_TRUE((grown & layer.cells()[group[j]].region).empty());
      }
    }
  }
  EXPECT_EQ(cells, layer.cells().size());
}

INSTANTIATE_TEST_SUITE_P(Sizes, LayerTilings,
                         testing::Values(Tiling{45, 37, 4}, Tiling{45, 37, 13}, Tiling{45, 37, 40}, Tiling{45, 37, 100},
                                         Tiling{1, 1, 1}, Tiling{9, 1, 2}, Tiling{7, 8, 1}, Tiling{23, 20, 3}));

TEST(Layer, NarrowStripsBelongToTheLastCell) {
  // 13 = 5 + 5 + 3: 3 is more than half a cell, a cell of its own; 12 = 5 + 7.
  EXPECT_EQ(Layer({13, 5}, 5).cells().back().core, cv::Rect(10, 0, 3, 5));
  EXPECT_EQ(Layer({12, 5}, 5).cells().back().core, cv::Rect(5, 0, 7, 5));
}

}  // namespace
}  // namespace fdp_stereo::local_expansion
