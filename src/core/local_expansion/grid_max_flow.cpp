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
  nodes_.assign(static_cast<std::size_t>(stride_) * (height + 2), Node{});
  active_.clear();
  active_front_ = 0;
  flow_ = 0.0;
  time_ = 0;
}

void GridMaxFlow::setEdge(int x, int y, int direction, float capacity, float reverse) {
  Node* node = &nodes_[index(x, y)];
  node->capacity[direction] = capacity;
  node[offset_[direction]].capacity[direction ^ 4] = reverse;
}

void GridMaxFlow::load(int width, int height, const float* terminal, const std::array<const float*, 4>& edges,
                       int pitch) {
  reset(width, height);
  for (int y = 0; y < height; ++y) {
    Node* node = &nodes_[index(0, y)];
    for (int x = 0; x < width; ++x, ++node) {
      const std::size_t p = static_cast<std::size_t>(y) * pitch + x;
      node->terminal = -terminal[p];
      for (int d = 0; d < 4; ++d) {
        const float value = edges[d][p];
        node->capacity[d] = value;
        node[offset_[d]].capacity[d ^ 4] = value;
      }
    }
  }
}

double GridMaxFlow::solve() {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) settle(&nodes_[index(x, y)]);
  }
  for (int y = height_ - 1; y >= 0; --y) {
    for (int x = width_ - 1; x >= 0; --x) settle(&nodes_[index(x, y)]);
  }
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) passOn(&nodes_[index(x, y)]);
  }
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

// A node that can saturate all its edges from its own terminal may do so: in every minimum cut it lies with that
// terminal (or may lie there), and its neighbours get what flows over.
void GridMaxFlow::settle(Node* node) {
  const float terminal = node->terminal;
  if (terminal == 0.0F) return;
  const bool source = terminal > 0.0F;
  float sum = 0.0F;
  for (int d = 0; d < kDirections; ++d) sum += source ? node->capacity[d] : node[offset_[d]].capacity[d ^ 4];
  if (sum == 0.0F || sum > std::fabs(terminal)) return;
  const float sign = source ? 1.0F : -1.0F;
  for (int d = 0; d < kDirections; ++d) {
    Node* other = node + offset_[d];
    float& used = source ? node->capacity[d] : other->capacity[d ^ 4];
    float& opposite = source ? other->capacity[d ^ 4] : node->capacity[d];
    const float amount = used;
    if (amount == 0.0F) continue;
    const float missing = -sign * other->terminal;  // what the opposite terminal of the neighbour can take
    if (missing > 0.0F) flow_ += static_cast<double>(std::min(amount, missing));
    other->terminal += sign * amount;
    opposite += amount;
    used = 0.0F;
  }
  node->terminal = source ? std::max(terminal - sum, 0.0F) : std::min(terminal + sum, 0.0F);
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
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      Node* node = &nodes_[index(x, y)];
      if (node->terminal < 0.0F) node->side = kSink;
      if (node->terminal <= 0.0F) continue;
      node->side = kSource;
      node->parent = kTerminal;
      node->distance = 1;
      activate(node);
    }
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
