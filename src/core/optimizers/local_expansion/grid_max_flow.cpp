// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/grid_max_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fdp_stereo::local_expansion {

void GridMaxFlow::reset(int width, int height) {
  const int stride = width + 2;  // a ring of places without nodes stands in for tests of the border
  const std::size_t size = static_cast<std::size_t>(stride) * (height + 2);
  if (stride == stride_ && size == places_.size()) {
    for (Node* node : nodes_) *node = Node{};
  } else {
    places_.assign(size, Node{});
  }
  stride_ = stride;
  for (int d = 0; d < kDirections; ++d) offset_[d] = kDy[d] * stride_ + kDx[d];
  nodes_.clear();
  active_.clear();
  active_front_ = 0;
  flow_ = 0.0;
  time_ = 0;
}

void GridMaxFlow::addNode(int x, int y, float terminal) {
  Node* node = &places_[index(x, y)];
  node->terminal = terminal;
  nodes_.push_back(node);
}

void GridMaxFlow::setEdge(int x, int y, int direction, float capacity, float reverse) {
  Node* node = &places_[index(x, y)];
  node->capacity[direction] = capacity;
  node[offset_[direction]].capacity[direction ^ 4] = reverse;
}

double GridMaxFlow::solve() {
  for (Node* node : nodes_) passOn(node);
  plantTree();
  while (Node* node = nextActive()) {
    for (int direction = grow(node); direction >= 0; direction = grow(node)) {
      ++time_;
      augment(node, direction);
      for (std::size_t k = 0; k < orphans_.size(); ++k) adopt(orphans_[k]);
      orphans_.clear();
      if (node->side == kFree) break;
    }
  }
  return flow_;
}

// Augments all paths source - node - neighbour - sink.
void GridMaxFlow::passOn(Node* node) {
  float rest = node->terminal;
  if (rest <= 0.0F) return;
  for (int d = 0; d < kDirections && rest > 0.0F; ++d) {
    Node* other = node + offset_[d];
    const float amount = std::min(std::min(rest, node->capacity[d]), -other->terminal);
    if (amount <= 0.0F) continue;
    node->capacity[d] -= amount;
    other->capacity[d ^ 4] += amount;
    other->terminal += amount;
    rest -= amount;
    flow_ += static_cast<double>(amount);
  }
  node->terminal = rest;
}

void GridMaxFlow::plantTree() {
  for (Node* node : nodes_) {
    if (node->terminal < 0.0F) node->side = kSink;
    if (node->terminal <= 0.0F) continue;
    node->side = kSource;
    node->parent = kTerminal;
    node->distance = 1;
    activate(node);
  }
}

void GridMaxFlow::activate(Node* node) {
  if (node->is_active) return;
  node->is_active = true;
  active_.push_back(node);
}

GridMaxFlow::Node* GridMaxFlow::nextActive() {
  while (active_front_ < active_.size()) {
    Node* node = active_[active_front_++];
    node->is_active = false;
    if (node->side == kSource) return node;
  }
  return nullptr;
}

int GridMaxFlow::grow(Node* node) {
  const int stamp = node->stamp;
  const int distance = node->distance + 1;
  for (int d = 0; d < kDirections; ++d) {
    if (node->capacity[d] <= 0.0F) continue;
    Node* other = node + offset_[d];
    if (other->side == kSink) return d;
    const bool free = other->side == kFree;
    if (!free && (other->stamp > stamp || other->distance <= distance)) continue;
    other->parent = static_cast<std::uint8_t>(d ^ 4);  // a way to the root, or a shorter one
    other->stamp = stamp;
    other->distance = distance;
    if (!free) continue;
    other->side = kSource;
    activate(other);
  }
  return -1;
}

void GridMaxFlow::augment(Node* node, int direction) {
  Node* sink = node + offset_[direction];
  float flow = std::min(node->capacity[direction], -sink->terminal);
  Node* root = node;
  while (root->parent != kTerminal) {
    const int up = root->parent;
    root += offset_[up];
    flow = std::min(flow, root->capacity[up ^ 4]);
  }
  flow = std::min(flow, root->terminal);
  node->capacity[direction] -= flow;
  sink->capacity[direction ^ 4] += flow;
  sink->terminal += flow;
  if (sink->terminal == 0.0F) sink->side = kFree;
  for (Node* k = node; k != root;) {
    const int up = k->parent;
    Node* parent = k + offset_[up];
    parent->capacity[up ^ 4] -= flow;
    k->capacity[up] += flow;
    if (parent->capacity[up ^ 4] <= 0.0F) makeOrphan(k);
    k = parent;
  }
  root->terminal -= flow;
  if (root->terminal == 0.0F) makeOrphan(root);
  flow_ += static_cast<double>(flow);
}

void GridMaxFlow::makeOrphan(Node* node) {
  node->parent = kOrphan;
  orphans_.push_back(node);
}

void GridMaxFlow::adopt(Node* node) {
  int best = std::numeric_limits<int>::max();
  int best_direction = -1;
  for (int d = 0; d < kDirections; ++d) {
    Node* other = node + offset_[d];
    if (other->side != kSource || other->capacity[d ^ 4] <= 0.0F) continue;
    const int distance = distanceToRoot(other);
    if (distance < best) {
      best = distance;
      best_direction = d;
    }
  }
  if (best_direction < 0) {
    release(node);
    return;
  }
  node->parent = static_cast<std::uint8_t>(best_direction);
  node->stamp = time_;
  node->distance = best + 1;
}

void GridMaxFlow::release(Node* node) {
  for (int d = 0; d < kDirections; ++d) {
    Node* other = node + offset_[d];
    if (other->side != kSource) continue;
    if (other->capacity[d ^ 4] > 0.0F) activate(other);
    if (other->parent == (d ^ 4)) makeOrphan(other);
  }
  node->side = kFree;
}

int GridMaxFlow::distanceToRoot(Node* node) {
  int steps = 0;
  Node* k = node;
  while (k->stamp != time_) {
    if (k->parent == kOrphan) return std::numeric_limits<int>::max();
    if (k->parent == kTerminal) {
      k->stamp = time_;
      k->distance = 1;
      break;
    }
    ++steps;
    k += offset_[k->parent];
  }
  const int result = steps + k->distance;
  int distance = result;
  for (k = node; k->stamp != time_; k += offset_[k->parent], --distance) {
    k->stamp = time_;
    k->distance = distance;
  }
  return result;
}

}  // namespace fdp_stereo::local_expansion
