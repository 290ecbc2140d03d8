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
/// (PAMI 2004). It is made for graphs in which nearly every node has a terminal edge, as those of expansion moves do:
/// only the source has a tree. It meets a node with residual capacity to the sink everywhere, so a tree that grows from
/// the sink would not pay.
///
/// Neighbours are implicit, places without a node cost next to nothing, and the memory is kept between graphs.
/// Capacities are float and never negative; sums of integers below 2^24 are exact. One instance per thread.
class GridMaxFlow {
 public:
  static constexpr int kDirections = 8;
  /// Steps of the directions: E, SE, S, SW and then their opposites, so that direction ^ 4 is the opposite.
  static constexpr std::array<int, kDirections> kDx = {1, 1, 0, -1, -1, -1, 0, 1};
  static constexpr std::array<int, kDirections> kDy = {0, 1, 1, 1, 0, -1, -1, -1};

  /// A graph without nodes on a grid of width x height places (both at least 1).
  void reset(int width, int height);
  /// A node at (x, y), at most once, with a capacity from the source (terminal > 0) or to the sink (terminal < 0).
  void addNode(int x, int y, float terminal);
  /// Capacities of the edge from (x, y) in `direction` and of the reverse edge. Both ends must be nodes when solve() is
  /// called.
  void setEdge(int x, int y, int direction, float capacity, float reverse);

  /// Finds the maximum flow and returns its value; call once after the capacities are set.
  double solve();
  /// After solve(): is there a node at (x, y), on the source side of the minimum cut? Of all minimum cuts it is the one
  /// with the smallest source side: nodes that are free to choose lie on the sink side.
  bool onSourceSide(int x, int y) const { return places_[index(x, y)].side == kSource; }

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

  int stride_ = 0;
  std::array<int, kDirections> offset_{};
  double flow_ = 0.0;
  int time_ = 0;
  std::vector<Node> places_;
  std::vector<Node*> nodes_;
  std::vector<Node*> active_;  // a queue; entries before active_front_ are done
  std::size_t active_front_ = 0;
  std::vector<Node*> orphans_;  // a queue likewise
};

}  // namespace fdp_stereo::local_expansion
