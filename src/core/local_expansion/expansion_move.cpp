// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "local_expansion/expansion_move.hpp"

#include <algorithm>
#include <cmath>

namespace fdp_stereo::local_expansion {
namespace {

// A change must gain this much to be worth swapping labels; below it, rounding decides.
constexpr double kSmallestGain = 1e-4;

constexpr std::array<int, kPairDirections> kDx = {1, 1, 0, -1};
constexpr std::array<int, kPairDirections> kDy = {0, 1, 1, 1};

bool contains(const cv::Rect& r, int x, int y) {
  return x >= r.x && y >= r.y && x < r.x + r.width && y < r.y + r.height;
}

void grow(std::vector<float>& buffer, std::size_t size) {
  if (buffer.size() < size) buffer.resize(size);
}

}  // namespace

void ExpansionMove::begin(const Smoothness& smoothness, const cv::Rect& region, Labels& labels) {
  labels_ = &labels;
  region_ = region;
  outer_ = cv::Rect(region.x - 1, region.y - 1, region.width + 2, region.height + 2) &
           cv::Rect(0, 0, labels.width, labels.height);
  inner_ = region - outer_.tl();
  keep_known_ = false;
  const std::size_t size = static_cast<std::size_t>(outer_.area());
  move_.pairs = smoothness.task(outer_, labels);
  for (int d = 0; d < kPairDirections; ++d) {
    grow(keep_[d], size);
    grow(edge_[d], size);
    move_.pairs.keep[d] = keep_[d].data();
    move_.edge[d] = edge_[d].data();
  }
  grow(terminal_, size);
  grow(scratch_, 4 * size);
  move_.terminal = terminal_.data();
  move_.scratch = scratch_.data();
  grow(keep_sum_, static_cast<std::size_t>(region.area()));
  takes_.resize(std::max(takes_.size(), static_cast<std::size_t>(region.area())));
}

double ExpansionMove::offer(const Plane& plane, const float* costs) {
  if (!keep_known_) computeKeep();
  if (hopeless(costs)) return 0.0;
  computeTerms(plane, costs);
  const int decision = obvious();
  if (decision < 0) return 0.0;
  if (decision > 0) {
    std::fill(takes_.begin(), takes_.begin() + region_.area(), std::uint8_t{1});
  } else {
    cut();
  }
  const double gain = change();
  if (gain > -kSmallestGain) return 0.0;
  apply(plane, costs);
  return gain;
}

double ExpansionMove::offerUnary(const Plane& plane, const float* costs) {
  double sum = 0.0;
  std::size_t i = 0;
  for (int y = region_.y; y < region_.y + region_.height; ++y) {
    for (int x = region_.x; x < region_.x + region_.width; ++x, ++i) {
      const float gain = costs[i] - labels_->cost[labels_->index(x, y)];
      takes_[i] = gain < 0.0F ? 1 : 0;
      if (gain < 0.0F) sum += static_cast<double>(gain);
    }
  }
  apply(plane, costs);
  return sum;
}

void ExpansionMove::computeKeep() {
  const LocalExpansionKernels& kernels = FDP_STEREO_SELECT(localExpansionKernels);
  kernels.keepCosts(move_.pairs);
  keep_known_ = true;
  std::size_t i = 0;
  for (int y = inner_.y; y < inner_.y + inner_.height; ++y) {
    const float* cost = labels_->cost.data() + labels_->index(region_.x, outer_.y + y);
    for (int x = inner_.x; x < inner_.x + inner_.width; ++x, ++i) {
      float sum = cost[x - inner_.x];
      for (int d = 0; d < kPairDirections; ++d) {
        sum += keep_[d][at(x, y)];
        const int px = x - kDx[d];
        const int py = y - kDy[d];
        if (px >= 0 && px < outer_.width && py >= 0) sum += keep_[d][at(px, py)];
      }
      keep_sum_[i] = sum;
    }
  }
}

// Pixels that take a plane gain at most their current data term and all their current pairs, and pay its data term:
// when this does not pay for any pixel alone, no set of pixels gains.
bool ExpansionMove::hopeless(const float* costs) const {
  const int size = region_.area();
  int gainers = 0;
  for (int i = 0; i < size; ++i) gainers += costs[i] < keep_sum_[i] ? 1 : 0;
  return gainers == 0;
}

void ExpansionMove::computeTerms(const Plane& plane, const float* costs) {
  const LocalExpansionKernels& kernels = FDP_STEREO_SELECT(localExpansionKernels);
  move_.a = plane.a;
  move_.b = plane.b;
  move_.c = plane.c;
  kernels.moveTerms(move_);
  fixBorder();
  for (int y = 0; y < inner_.height; ++y) {
    const float* current = labels_->cost.data() + labels_->index(region_.x, region_.y + y);
    float* terminal = terminal_.data() + at(inner_.x, inner_.y + y);
    const float* proposed = costs + static_cast<std::size_t>(y) * inner_.width;
    for (int x = 0; x < inner_.width; ++x) terminal[x] += proposed[x] - current[x];
  }
}

// The ring keeps its labels (x_q = 0), so an edge between it and the region is a term of the inner pixel alone.
void ExpansionMove::fixBorder() {
  const auto fix = [this](int x, int y) {
    for (int d = 0; d < kPairDirections; ++d) {
      const int qx = x + kDx[d];
      const int qy = y + kDy[d];
      if (qx < 0 || qx >= outer_.width || qy >= outer_.height) continue;
      const bool first = contains(inner_, x, y);
      const bool second = contains(inner_, qx, qy);
      if (first == second) continue;
      float& edge = edge_[d][at(x, y)];
      terminal_[first ? at(x, y) : at(qx, qy)] += edge;
      edge = 0.0F;
    }
  };
  // Every crossing edge starts in the outermost two rows or columns.
  for (int y = 0; y < outer_.height; ++y) {
    const bool whole_row = y <= 1 || y >= outer_.height - 2;
    for (int x = 0; x < outer_.width; ++x) {
      if (!whole_row && x == 2 && outer_.width > 4) x = outer_.width - 2;
      fix(x, y);
    }
  }
}

int ExpansionMove::obvious() const {
  bool any_takes = false;
  bool any_keeps = false;
  for (int y = 0; y < inner_.height; ++y) {
    const float* terminal = terminal_.data() + at(inner_.x, inner_.y + y);
    for (int x = 0; x < inner_.width; ++x) {
      any_takes |= terminal[x] < 0.0F;
      any_keeps |= terminal[x] >= 0.0F;
    }
  }
  if (!any_takes) return -1;
  return any_keeps ? 0 : 1;
}

void ExpansionMove::cut() {
  const std::size_t corner = at(inner_.x, inner_.y);
  const std::array<const float*, kPairDirections> edges = {edge_[0].data() + corner, edge_[1].data() + corner,
                                                           edge_[2].data() + corner, edge_[3].data() + corner};
  flow_.load(inner_.width, inner_.height, terminal_.data() + corner, edges, outer_.width);
  flow_.solve();
  for (int y = 0, i = 0; y < inner_.height; ++y) {
    for (int x = 0; x < inner_.width; ++x, ++i) takes_[i] = flow_.onSourceSide(x, y) ? 1 : 0;
  }
}

double ExpansionMove::change() const {
  double sum = 0.0;
  for (int y = 0; y < inner_.height; ++y) {
    const std::uint8_t* takes = takes_.data() + static_cast<std::size_t>(y) * inner_.width;
    for (int x = 0; x < inner_.width; ++x) {
      const std::size_t p = at(inner_.x + x, inner_.y + y);
      if (takes[x] != 0) sum += static_cast<double>(terminal_[p]);
      for (int d = 0; d < kPairDirections; ++d) {
        if (edge_[d][p] == 0.0F) continue;  // edges out of the region are 0
        if (takes[x] != takes[x + kDx[d] + kDy[d] * inner_.width]) sum += static_cast<double>(edge_[d][p]);
      }
    }
  }
  return sum;
}

void ExpansionMove::apply(const Plane& plane, const float* costs) {
  std::size_t i = 0;
  for (int y = region_.y; y < region_.y + region_.height; ++y) {
    for (int x = region_.x; x < region_.x + region_.width; ++x, ++i) {
      if (takes_[i] == 0) continue;
      const std::size_t p = labels_->index(x, y);
      labels_->planes.set(p, plane);
      labels_->cost[p] = costs[i];
    }
  }
  keep_known_ = false;
}

}  // namespace fdp_stereo::local_expansion
