// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/grid_max_flow.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace fdp_stereo::local_expansion {
namespace {

constexpr std::array<int, 4> kDx = {1, 1, 0, -1};
constexpr std::array<int, 4> kDy = {0, 1, 1, 1};

/// A grid graph in plain form: forward[d] and backward[d] of each node's edge to its neighbour E, SE, S, SW.
struct Grid {
  int width = 0;
  int height = 0;
  std::vector<float> terminal;  // > 0 from the source, < 0 to the sink
  std::array<std::vector<float>, 4> forward, backward;

  Grid(int w, int h) : width(w), height(h), terminal(w * h, 0.0F) {
    for (int d = 0; d < 4; ++d) forward[d].assign(w * h, 0.0F);
    backward = forward;
  }
  bool hasEdge(int x, int y, int d) const {
    const int qx = x + kDx[d];
    return qx >= 0 && qx < width && y + kDy[d] < height;
  }
};

/// Small integers with many zeros and ties, or reals.
Grid randomGrid(std::mt19937& random, bool integers, bool symmetric) {
  std::uniform_int_distribution<int> side(1, 12);
  const int width = side(random);
  Grid grid(width, std::max(side(random), width == 1 ? 2 : 1));  // OpenCV's solver needs an edge
  std::uniform_int_distribution<int> whole(-3, 3);
  std::uniform_real_distribution<float> real(-2.0F, 2.0F);
  const auto value = [&] { return integers ? static_cast<float>(whole(random)) : real(random); };
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const int i = y * grid.width + x;
      grid.terminal[i] = 2.0F * value();
      for (int d = 0; d < 4; ++d) {
        if (!grid.hasEdge(x, y, d)) continue;
        grid.forward[d][i] = std::max(0.0F, value());
        grid.backward[d][i] = symmetric ? grid.forward[d][i] : std::max(0.0F, value());
      }
    }
  }
  return grid;
}

void build(const Grid& grid, GridMaxFlow& flow) {
  flow.reset(grid.width, grid.height);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const int i = y * grid.width + x;
      flow.addNode(x, y, grid.terminal[i]);
      for (int d = 0; d < 4; ++d) {
        if (grid.hasEdge(x, y, d)) flow.setEdge(x, y, d, grid.forward[d][i], grid.backward[d][i]);
      }
    }
  }
}

double opencvFlow(const Grid& grid) {
  cv::detail::GCGraph<double> graph(grid.width * grid.height, grid.width * grid.height * 4);
  for (const float t : grid.terminal) {
    graph.addTermWeights(graph.addVtx(), std::max(t, 0.0F), std::max(-t, 0.0F));
  }
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const int i = y * grid.width + x;
      for (int d = 0; d < 4; ++d) {
        if (!grid.hasEdge(x, y, d)) continue;
        graph.addEdges(i, i + kDx[d] + kDy[d] * grid.width, grid.forward[d][i], grid.backward[d][i]);
      }
    }
  }
  return graph.maxFlow();
}

/// Capacity of the cut that the solver's two sides make.
double cutCost(const Grid& grid, const GridMaxFlow& flow) {
  double sum = 0.0;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const int i = y * grid.width + x;
      const bool source = flow.onSourceSide(x, y);
      sum += source ? std::max(-grid.terminal[i], 0.0F) : std::max(grid.terminal[i], 0.0F);
      for (int d = 0; d < 4; ++d) {
        if (!grid.hasEdge(x, y, d)) continue;
        const bool other = flow.onSourceSide(x + kDx[d], y + kDy[d]);
        if (source && !other) sum += grid.forward[d][i];
        if (!source && other) sum += grid.backward[d][i];
      }
    }
  }
  return sum;
}

TEST(GridMaxFlow, TwoNodesWorkedByHand) {
  // source -5-> a -3-> b -4-> sink: the edge is the bottleneck, a stays with the source, b with the sink.
  GridMaxFlow flow;
  flow.reset(2, 1);
  flow.addNode(0, 0, 5.0F);
  flow.addNode(1, 0, -4.0F);
  flow.setEdge(0, 0, 0, 3.0F, 1.0F);
  EXPECT_EQ(flow.solve(), 3.0);
  EXPECT_TRUE(flow.onSourceSide(0, 0));
  EXPECT_FALSE(flow.onSourceSide(1, 0));
}

TEST(GridMaxFlow, FreeNodesLieOnTheSinkSide) {
  // source -2-> a -2-> b -2-> sink: every edge is a minimum cut; the smallest source side is empty.
  GridMaxFlow flow;
  flow.reset(2, 1);
  flow.addNode(0, 0, 2.0F);
  flow.addNode(1, 0, -2.0F);
  flow.setEdge(0, 0, 0, 2.0F, 0.0F);
  EXPECT_EQ(flow.solve(), 2.0);
  EXPECT_FALSE(flow.onSourceSide(0, 0));
  EXPECT_FALSE(flow.onSourceSide(1, 0));
}

TEST(GridMaxFlow, IntegerGridsHaveOpenCvsFlowExactly) {
  std::mt19937 random(1);
  GridMaxFlow flow;
  for (int i = 0; i < 4000; ++i) {
    const Grid grid = randomGrid(random, true, i % 2 == 0);
    build(grid, flow);
    const double value = flow.solve();
    ASSERT_EQ(value, opencvFlow(grid)) << "grid " << i << " of " << grid.width << " x " << grid.height;
    ASSERT_EQ(value, cutCost(grid, flow)) << "grid " << i << " of " << grid.width << " x " << grid.height;
  }
}

TEST(GridMaxFlow, RealGridsHaveOpenCvsFlow) {
  std::mt19937 random(2);
  GridMaxFlow flow;
  for (int i = 0; i < 2000; ++i) {
    const Grid grid = randomGrid(random, false, i % 2 == 0);
    build(grid, flow);
    const double value = flow.solve();
    ASSERT_NEAR(value, opencvFlow(grid), 1e-3) << "grid " << i;
    ASSERT_NEAR(value, cutCost(grid, flow), 1e-3) << "grid " << i;
  }
}

TEST(GridMaxFlow, SmallestSourceSideOnTies) {
  // No node can leave the source side of the returned cut: any other minimum cut found by brute force contains it.
  std::mt19937 random(3);
  std::uniform_int_distribution<int> whole(-2, 2);
  GridMaxFlow flow;
  for (int i = 0; i < 300; ++i) {
    Grid grid(3, 3);
    for (int k = 0; k < 9; ++k) {
      grid.terminal[k] = static_cast<float>(whole(random));
      for (int d = 0; d < 4; ++d) {
        if (!grid.hasEdge(k % 3, k / 3, d)) continue;
        grid.forward[d][k] = static_cast<float>(std::max(0, whole(random)));
        grid.backward[d][k] = static_cast<float>(std::max(0, whole(random)));
      }
    }
    build(grid, flow);
    const double minimum = flow.solve();
    unsigned chosen = 0;
    for (int k = 0; k < 9; ++k) chosen |= flow.onSourceSide(k % 3, k / 3) ? 1U << k : 0U;
    for (unsigned side = 0; side < 512; ++side) {
      double sum = 0.0;
      for (int k = 0; k < 9; ++k) {
        const bool source = (side >> k & 1U) != 0;
        sum += source ? std::max(-grid.terminal[k], 0.0F) : std::max(grid.terminal[k], 0.0F);
        for (int d = 0; d < 4; ++d) {
          if (!grid.hasEdge(k % 3, k / 3, d)) continue;
          const bool other = (side >> (k + kDx[d] + 3 * kDy[d]) & 1U) != 0;
          if (source && !other) sum += grid.forward[d][k];
          if (!source && other) sum += grid.backward[d][k];
        }
      }
      ASSERT_GE(sum, minimum);
      if (sum == minimum) {
        ASSERT_EQ(chosen & side, chosen) << "grid " << i;
      }
    }
  }
}

}  // namespace
}  // namespace fdp_stereo::local_expansion
