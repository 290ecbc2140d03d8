// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/expansion_move.hpp"

#include <algorithm>
#include <cmath>

namespace fdp_stereo::local_expansion {
namespace {

// A change must gain this much to be worth swapping labels; below it, rounding decides.
constexpr double kSmallestGain = 1e-4;

const LocalExpansionKernels& kernels() { return FDP_STEREO_SELECT(localExpansionKernels); }

}  // namespace

float* ExpansionMove::Field::create(std::size_t size, std::size_t margin) {
  margin_ = margin;
  if (values_.size() < size + 2 * margin) values_.resize(size + 2 * margin);
  return data();
}

void ExpansionMove::begin(const Smoothness& smoothness, const cv::Rect& region, Labels& labels) {
  labels_ = &labels;
  smoothness_ = &smoothness;
  region_ = region;
  prepared_ = false;
  keep_known_ = false;
}

double ExpansionMove::offer(const Plane& plane, const float* costs) {
  if (!prepared_) prepare();
  if (!keep_known_) kernels().keepCosts(task_);
  keep_known_ = true;
  if (hopeless(costs)) return 0.0;
  task_.plane_a = plane.a;
  task_.plane_b = plane.b;
  task_.plane_c = plane.c;
  task_.proposed = costs;
  kernels().moveTerms(task_);
  if (!decide()) return 0.0;
  const double gain = kernels().moveChange(task_);
  if (gain > -kSmallestGain) return 0.0;
  apply(plane, costs);
  return gain;
}

double ExpansionMove::offerUnary(const Plane& plane, const float* costs) {
  double sum = 0.0;
  for (int y = region_.y; y < region_.y + region_.height; ++y) {
    for (int x = region_.x; x < region_.x + region_.width; ++x, ++costs) {
      const std::size_t p = labels_->index(x, y);
      const float gain = *costs - labels_->cost[p];
      if (gain >= 0.0F) continue;
      labels_->planes.set(p, plane);
      labels_->cost[p] = *costs;
      sum += static_cast<double>(gain);
    }
  }
  prepared_ = false;
  return sum;
}

void ExpansionMove::prepare() {
  createFields();
  copyLabels();
  prepared_ = true;
  keep_known_ = false;
}

void ExpansionMove::createFields() {
  task_.width = region_.width;
  task_.rows = region_.height + 2;
  task_.pitch = (region_.width + 2 + kMoveLanes - 1) / kMoveLanes * kMoveLanes;
  task_.x0 = region_.x - 1;
  task_.y0 = region_.y - 1;
  task_.threshold = smoothness_->tau();
  const auto create = [this](Field& field) {
    return field.create(static_cast<std::size_t>(task_.rows) * task_.pitch, task_.pitch + kMoveLanes);
  };
  for (int d = 0; d < kPairDirections; ++d) {
    task_.weights[d] = create(weights_[d]);
    task_.keep[d] = create(keep_[d]);
    task_.edge[d] = create(edge_[d]);
  }
  task_.a = create(a_);
  task_.b = create(b_);
  task_.c = create(c_);
  task_.cost = create(cost_);
  task_.inner = create(inner_);
  task_.keep_sum = create(keep_sum_);
  task_.da = create(da_);
  task_.db = create(db_);
  task_.dd = create(dd_);
  task_.terminal = create(terminal_);
  task_.total = create(total_);
  task_.share = create(share_);
  task_.lower = create(lower_);
  task_.upper = create(upper_);
  stale_.resize(std::max(stale_.size(), static_cast<std::size_t>(task_.rows)));
  task_.stale = stale_.data();
}

void ExpansionMove::copyLabels() {
  const int first = std::max(task_.x0, 0);
  const int count = std::min(task_.x0 + region_.width + 2, labels_->width) - first;
  for (int d = 0; d < kPairDirections; ++d) {
    std::fill_n(weights_[d].data(), static_cast<std::size_t>(task_.rows) * task_.pitch, 0.0F);
  }
  std::fill_n(inner_.data(), static_cast<std::size_t>(task_.rows) * task_.pitch, 0.0F);
  for (int y = 0; y < region_.height; ++y) std::fill_n(inner_.data() + at(0, y), region_.width, 1.0F);
  for (int y = std::max(task_.y0, 0); y < std::min(task_.y0 + task_.rows, labels_->height); ++y) {
    const std::size_t from = labels_->index(first, y);
    const std::ptrdiff_t to = at(first - region_.x, y - region_.y);
    std::copy_n(labels_->planes.a.data() + from, count, a_.data() + to);
    std::copy_n(labels_->planes.b.data() + from, count, b_.data() + to);
    std::copy_n(labels_->planes.c.data() + from, count, c_.data() + to);
    std::copy_n(labels_->cost.data() + from, count, cost_.data() + to);
    for (int d = 0; d < kPairDirections; ++d) {
      std::copy_n(smoothness_->weights(d) + from, count, weights_[d].data() + to);
    }
  }
}

// Pixels that take a plane gain at most their current data term and all their current pairs, and pay its data term:
// when this does not pay for any pixel alone, no set of pixels gains.
bool ExpansionMove::hopeless(const float* costs) const {
  int gainers = 0;
  for (int y = 0; y < region_.height; ++y, costs += region_.width) {
    const float* keep = task_.keep_sum + at(0, y);
    for (int x = 0; x < region_.width; ++x) gainers += costs[x] < keep[x] ? 1 : 0;
  }
  return gainers == 0;
}

// Finds the best move, into task_.lower; false if it is to keep everything.
bool ExpansionMove::decide() {
  const std::size_t size = static_cast<std::size_t>(task_.rows) * task_.pitch;
  std::copy_n(inner_.data(), size, upper_.data());
  kernels().improve(task_, task_.upper);
  if (std::none_of(task_.upper, task_.upper + size, [](float x) { return x != 0.0F; })) return false;
  std::fill_n(lower_.data(), size, 0.0F);
  kernels().improve(task_, task_.lower);
  cut();
  return true;
}

float ExpansionMove::edgeTo(std::ptrdiff_t p, int direction) const {
  const std::ptrdiff_t step = GridMaxFlow::kDy[direction] * task_.pitch + GridMaxFlow::kDx[direction];
  return direction < kPairDirections ? task_.edge[direction][p] : task_.edge[direction ^ 4][p + step];
}

// What is between the bounds is decided by a minimum cut; edges to decided pixels become part of the terminals.
void ExpansionMove::cut() {
  flow_.reset(region_.width, region_.height);
  for (int y = 0; y < region_.height; ++y) {
    for (int x = 0; x < region_.width; ++x) {
      const std::ptrdiff_t p = at(x, y);
      if (task_.upper[p] == task_.lower[p]) continue;
      float terminal = task_.terminal[p];
      for (int d = 0; d < GridMaxFlow::kDirections; ++d) {
        const std::ptrdiff_t q = p + GridMaxFlow::kDy[d] * task_.pitch + GridMaxFlow::kDx[d];
        const float edge = edgeTo(p, d);
        if (task_.upper[q] == task_.lower[q]) {
          terminal += task_.lower[q] != 0.0F ? -edge : edge;
        } else if (d < kPairDirections) {
          flow_.setEdge(x, y, d, edge, edge);
        }
      }
      flow_.addNode(x, y, -terminal);
    }
  }
  flow_.solve();
  for (int y = 0; y < region_.height; ++y) {
    for (int x = 0; x < region_.width; ++x) {
      if (flow_.onSourceSide(x, y)) task_.lower[at(x, y)] = 1.0F;
    }
  }
}

void ExpansionMove::apply(const Plane& plane, const float* costs) {
  for (int y = 0; y < region_.height; ++y) {
    for (int x = 0; x < region_.width; ++x, ++costs) {
      const std::ptrdiff_t i = at(x, y);
      if (task_.lower[i] == 0.0F) continue;
      const std::size_t p = labels_->index(region_.x + x, region_.y + y);
      labels_->planes.set(p, plane);
      labels_->cost[p] = *costs;
      a_.data()[i] = plane.a;
      b_.data()[i] = plane.b;
      c_.data()[i] = plane.c;
      cost_.data()[i] = *costs;
    }
  }
  keep_known_ = false;
}

}  // namespace fdp_stereo::local_expansion
