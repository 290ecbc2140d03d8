// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fdp_stereo::local_expansion {

/// Maximum flow and minimum cut of a grid with 8 neighbours per node, by augmenting paths with a search tree that is
/// kept from path to path, after Boykov and Kolmogorov, "An experimental comparison of min-cut/max-flow algorithms"
/// (PAMI 2004). Two things are made for graphs in which nearly every node has a terminal edge, as those of expansion
/// moves do: nodes that could saturate all their edges are settled first, and only the source has a tree - it meets a
/// node with residual capacity to the sink everywhere, so a tree that grows from the sink would not pay.
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
  void setTerminal(int x, int y, float value) { nodes_[index(x, y)].terminal = value; }
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
  bool onSourceSide(int x, int y) const { return nodes_[index(x, y)].side == kSource; }

 private:
  enum Side : std::uint8_t { kFree, kSource, kSink };  // kSink: residual capacity to the sink itself
  static constexpr std::uint8_t kTerminal = 8;         // parent: the source itself
  static constexpr std::uint8_t kOrphan = 9;           // parent: lost, or never had one

  struct Node {
    std::array<float, kDirections> capacity{};  // residual, to the neighbours
    float terminal = 0.0F;                      // residual capacity from the source (> 0) or to the sink (< 0)
    int distance = 0;                           // to the root, as of stamp
    int stamp = 0;
    std::uint8_t side = kFree;
    std::uint8_t parent = kOrphan;  // direction of the parent, kTerminal or kOrphan
    bool is_active = false;
  };

  int index(int x, int y) const { return (y + 1) * stride_ + x + 1; }
  void settle(Node* node);
  void passOn(Node* node);
  void plantTree();
  void activate(Node* node);
  Node* nextActive();
  // Grows the tree of a node by one ring; returns the direction of an edge that meets a sink node, or -1.
  int grow(Node* node);
  void augment(Node* node, int direction);
  void adopt(Node* node);
  void release(Node* node);
  int distanceToRoot(Node* node);
  void makeOrphan(Node* node);

  int width_ = 0;
  int height_ = 0;
  int stride_ = 0;
  std::array<int, kDirections> offset_{};
  double flow_ = 0.0;
  int time_ = 0;
  std::vector<Node> nodes_;
  std::vector<Node*> active_;  // a queue; entries before active_front_ are done
  std::size_t active_front_ = 0;
  std::vector<Node*> orphans_;  // a queue likewise
};

}  // namespace fdp_stereo::local_expansion
