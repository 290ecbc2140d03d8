// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "local_expansion/grid_max_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fdp_stereo::local_expansion {

constexpr std::array<int, GridMaxFlow::kDirections> GridMaxFlow::kDx;
constexpr std::array<int, GridMaxFlow::kDirections> GridMaxFlow::kDy;

void GridMaxFlow::reset(int width, int height) {
  width_ = width;
  height_ = height;
  stride_ = width + 2;  // a ring of nodes without capacity stands in for tests of the border
  for (int d = 0; d < kDirections; ++d) offset_[d] = kDy[d] * stride_ + kDx[d];
  const std::size_t nodes = static_cast<std::size_t>(stride_) * (height + 2);
  terminal_.assign(nodes, 0.0F);
  capacity_.assign(nodes * kDirections, 0.0F);
  tree_.assign(nodes, kFree);
  parent_.assign(nodes, kOrphan);
  distance_.assign(nodes, 0);
  stamp_.assign(nodes, 0);
  is_active_.assign(nodes, 0);
  active_.clear();
  active_front_ = 0;
  flow_ = 0.0;
  time_ = 0;
}

void GridMaxFlow::setEdge(int x, int y, int direction, float value, float reverse) {
  const int i = node(x, y);
  capacity(i, direction) = value;
  capacity(i + offset_[direction], direction ^ 4) = reverse;
}

void GridMaxFlow::load(int width, int height, const float* terminal, const std::array<const float*, 4>& edges,
                       int pitch) {
  reset(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int i = node(x, y);
      const std::size_t p = static_cast<std::size_t>(y) * pitch + x;
      terminal_[i] = -terminal[p];
      for (int d = 0; d < 4; ++d) {
        const float value = edges[d][p];
        capacity(i, d) = value;
        capacity(i + offset_[d], d ^ 4) = value;
      }
    }
  }
}

double GridMaxFlow::solve() {
  plantTrees();
  for (int i = nextActive(); i >= 0; i = nextActive()) {
    for (int direction = grow(i); direction >= 0; direction = grow(i)) {
      ++time_;
      augment(i, direction);
      adoptOrphans();
      if (tree_[i] == kFree) break;
    }
  }
  return flow_;
}

void GridMaxFlow::plantTrees() {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const int i = node(x, y);
      if (terminal_[i] == 0.0F) continue;
      tree_[i] = terminal_[i] > 0.0F ? kSource : kSink;
      parent_[i] = kTerminal;
      distance_[i] = 1;
      activate(i);
    }
  }
}

void GridMaxFlow::activate(int i) {
  if (is_active_[i] != 0) return;
  is_active_[i] = 1;
  active_.push_back(i);
}

int GridMaxFlow::nextActive() {
  while (active_front_ < active_.size()) {
    const int i = active_[active_front_++];
    is_active_[i] = 0;
    if (tree_[i] != kFree) return i;
  }
  return -1;
}

int GridMaxFlow::grow(int i) {
  const std::uint8_t tree = tree_[i];
  for (int d = 0; d < kDirections; ++d) {
    if (residual(i, d, tree) <= 0.0F) continue;
    const int j = i + offset_[d];
    if (tree_[j] == kFree) {
      tree_[j] = tree;
      parent_[j] = static_cast<std::uint8_t>(d ^ 4);
      stamp_[j] = stamp_[i];
      distance_[j] = distance_[i] + 1;
      activate(j);
    } else if (tree_[j] != tree) {
      return d;
    } else if (stamp_[j] <= stamp_[i] && distance_[j] > distance_[i] + 1) {
      parent_[j] = static_cast<std::uint8_t>(d ^ 4);  // a shorter way to the root
      stamp_[j] = stamp_[i];
      distance_[j] = distance_[i] + 1;
    }
  }
  return -1;
}

void GridMaxFlow::augment(int i, int direction) {
  const bool forward = tree_[i] == kSource;
  const int j = i + offset_[direction];
  const int source_end = forward ? i : j;
  const int sink_end = forward ? j : i;
  const int along = forward ? direction : direction ^ 4;
  float flow = capacity(source_end, along);
  flow = bottleneck(source_end, kSource, flow);
  flow = bottleneck(sink_end, kSink, flow);
  capacity(source_end, along) -= flow;
  capacity(sink_end, along ^ 4) += flow;
  push(source_end, kSource, flow);
  push(sink_end, kSink, flow);
  flow_ += static_cast<double>(flow);
}

float GridMaxFlow::bottleneck(int i, std::uint8_t tree, float limit) {
  while (parent_[i] != kTerminal) {
    const int up = parent_[i];
    const int j = i + offset_[up];
    limit = std::min(limit, residual(j, up ^ 4, tree));
    i = j;
  }
  return std::min(limit, std::fabs(terminal_[i]));
}

void GridMaxFlow::push(int i, std::uint8_t tree, float flow) {
  while (parent_[i] != kTerminal) {
    const int up = parent_[i];
    const int j = i + offset_[up];
    const std::uint8_t other = tree == kSource ? kSink : kSource;
    float& rest = residual(j, up ^ 4, tree);
    rest -= flow;
    residual(j, up ^ 4, other) += flow;
    if (rest <= 0.0F) makeOrphan(i);
    i = j;
  }
  terminal_[i] += tree == kSource ? -flow : flow;
  if (terminal_[i] == 0.0F) makeOrphan(i);
}

void GridMaxFlow::makeOrphan(int i) {
  parent_[i] = kOrphan;
  orphans_.push_back(i);
}

void GridMaxFlow::adoptOrphans() {
  for (std::size_t k = 0; k < orphans_.size(); ++k) adopt(orphans_[k]);
  orphans_.clear();
}

void GridMaxFlow::adopt(int i) {
  const std::uint8_t tree = tree_[i];
  int best = std::numeric_limits<int>::max();
  int best_direction = -1;
  for (int d = 0; d < kDirections; ++d) {
    const int j = i + offset_[d];
    if (tree_[j] != tree || residual(j, d ^ 4, tree) <= 0.0F) continue;
    const int distance = distanceToRoot(j);
    if (distance < best) {
      best = distance;
      best_direction = d;
    }
  }
  if (best_direction < 0) {
    release(i);
    return;
  }
  parent_[i] = static_cast<std::uint8_t>(best_direction);
  stamp_[i] = time_;
  distance_[i] = best + 1;
}

void GridMaxFlow::release(int i) {
  const std::uint8_t tree = tree_[i];
  for (int d = 0; d < kDirections; ++d) {
    const int j = i + offset_[d];
    if (tree_[j] != tree) continue;
    if (residual(j, d ^ 4, tree) > 0.0F) activate(j);
    if (parent_[j] == (d ^ 4)) makeOrphan(j);
  }
  tree_[i] = kFree;
}

int GridMaxFlow::distanceToRoot(int i) {
  int steps = 0;
  int j = i;
  int rest = 0;
  while (true) {
    if (stamp_[j] == time_) {
      rest = distance_[j];
      break;
    }
    if (parent_[j] == kOrphan) return std::numeric_limits<int>::max();
    if (parent_[j] == kTerminal) {
      rest = 1;
      stamp_[j] = time_;
      distance_[j] = 1;
      break;
    }
    ++steps;
    j += offset_[parent_[j]];
  }
  for (int k = i, distance = steps + rest; stamp_[k] != time_; k += offset_[parent_[k]], --distance) {
    stamp_[k] = time_;
    distance_[k] = distance;
  }
  return steps + rest;
}

}  // namespace fdp_stereo::local_expansion
