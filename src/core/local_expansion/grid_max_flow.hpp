// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fdp_stereo::local_expansion {

/// Maximum flow and minimum cut of a grid with 8 neighbours per node, after Boykov and Kolmogorov, "An experimental
/// comparison of min-cut/max-flow algorithms" (PAMI 2004): two search trees grow from source and sink, meet, are
/// augmented along the meeting path, and adopt the orphans that saturated edges leave behind.
///
/// Neighbours are implicit and the memory is kept between graphs. Capacities are float and never negative; sums of
/// integers below 2^24 are exact. One instance per thread.
class GridMaxFlow {
 public:
  static constexpr int kDirections = 8;
  /// Steps of the directions: E, SE, S, SW and then their opposites, so that direction ^ 4 is the opposite.
  static constexpr std::array<int, kDirections> kDx = {1, 1, 0, -1, -1, -1, 0, 1};
  static constexpr std::array<int, kDirections> kDy = {0, 1, 1, 1, 0, -1, -1, -1};

  /// An empty graph of width x height nodes (both at least 1): every capacity 0.
  void reset(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }

  /// Capacity from the source (value > 0) or to the sink (value < 0) of node (x, y).
  void setTerminal(int x, int y, float value) { terminal_[node(x, y)] = value; }
  /// Capacities of the edge from (x, y) in `direction` and of the reverse edge. Both nodes must be in the grid.
  void setEdge(int x, int y, int direction, float capacity, float reverse);

  /// A whole graph at once, with edges of equal capacity in both directions: terminal[y * pitch + x] > 0 is a capacity
  /// to the sink (the cost of being on the source side), < 0 one from the source; edges[d][y * pitch + x] is the edge
  /// to the neighbour E, SE, S, SW, and must be 0 where that leaves the grid.
  void load(int width, int height, const float* terminal, const std::array<const float*, 4>& edges, int pitch);

  /// Finds the maximum flow and returns its value; call once after the capacities are set.
  double solve();
  /// After solve(): does (x, y) lie on the source side of the minimum cut? Of all minimum cuts it is the one with the
  /// smallest source side: nodes that are free to choose lie on the sink side.
  bool onSourceSide(int x, int y) const { return tree_[node(x, y)] == kSource; }

 private:
  enum Tree : std::uint8_t { kFree, kSource, kSink };
  static constexpr std::uint8_t kTerminal = 8;  // parent: the terminal itself
  static constexpr std::uint8_t kOrphan = 9;    // parent: lost, or never had one

  int node(int x, int y) const { return (y + 1) * stride_ + x + 1; }
  float& capacity(int i, int direction) { return capacity_[static_cast<std::size_t>(i) * kDirections + direction]; }
  // Residual capacity between node i and its neighbour in `direction` along the flow of the tree: away from the root
  // for the source tree, towards the root for the sink tree.
  float& residual(int i, int direction, std::uint8_t tree) {
    return tree == kSource ? capacity(i, direction) : capacity(i + offset_[direction], direction ^ 4);
  }
  void plantTrees();
  void activate(int i);
  int nextActive();
  // Grows the tree of i by one ring; returns the direction of an edge that meets the other tree, or -1.
  int grow(int i);
  void augment(int i, int direction);
  float bottleneck(int i, std::uint8_t tree, float limit);
  void push(int i, std::uint8_t tree, float flow);
  void adoptOrphans();
  void adopt(int i);
  void release(int i);
  int distanceToRoot(int i);
  void makeOrphan(int i);

  int width_ = 0;
  int height_ = 0;
  int stride_ = 0;
  std::array<int, kDirections> offset_{};
  double flow_ = 0.0;
  int time_ = 0;
  std::vector<float> terminal_;  // residual capacity from the source (> 0) or to the sink (< 0)
  std::vector<float> capacity_;  // residual capacities, [node][direction]
  std::vector<std::uint8_t> tree_;
  std::vector<std::uint8_t> parent_;  // direction of the parent, kTerminal or kOrphan
  std::vector<int> distance_;         // to the root, valid as of stamp_
  std::vector<int> stamp_;
  std::vector<std::uint8_t> is_active_;
  std::vector<int> active_;  // a queue; entries before active_front_ are done
  std::size_t active_front_ = 0;
  std::vector<int> orphans_;  // a queue likewise
};

}  // namespace fdp_stereo::local_expansion
