// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"

namespace fdp_stereo {

/// The largest cost of one path in raw units: four of them add up to 16 bits.
constexpr int largestPathCost(CostVolume::Depth depth) { return depth == CostVolume::Depth::kU8 ? 255 : 65535 / 4; }

/// How costs are stored: their depth, and the cost of one raw unit.
struct CostScale {
  CostVolume::Depth depth = CostVolume::Depth::kU8;
  float step = 1.0F;
};

/// The finest scale at which a cost of up to `max_cost` and `penalties` beside it fit one path cost: 8 bits, unless
/// these would leave fewer than `fewest_levels` to the costs themselves; then 16.
inline CostScale fitCostScale(double max_cost, double penalties, double fewest_levels = 48.0) {
  constexpr int kRounding = 3;  // of the cost and of both penalties
  const auto stepOf = [&](CostVolume::Depth depth) {
    return static_cast<float>((max_cost + penalties) / (largestPathCost(depth) - kRounding));
  };
  const float bytes = stepOf(CostVolume::Depth::kU8);
  if (max_cost >= fewest_levels * bytes) return {CostVolume::Depth::kU8, bytes};
  return {CostVolume::Depth::kU16, stepOf(CostVolume::Depth::kU16)};
}

}  // namespace fdp_stereo
