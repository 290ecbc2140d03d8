// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "fdp_stereo/cost_volume.hpp"
#include "optimizers/local_expansion/guided_filter.hpp"
#include "optimizers/local_expansion/plane.hpp"
#include "simd/local_expansion_kernels.hpp"

namespace fdp_stereo::local_expansion {

/// Cost of a plane at a pixel where it leaves the disparity range.
constexpr float kInvalidCost = 1e6F;

struct PlaneCostParams {
  double scale = 1.0;      ///< factor of the matching cost
  double threshold = 0.5;  ///< truncation of the matching cost, after scale
  int margin_px = 5;       ///< a plane is invalid where it leaves the range within this distance, in both axes
};

using PlaneBatch = std::array<Plane, kPlaneBatch>;

/// Costs of a batch over a rectangle, and the memory to compute them. One per thread.
class PlaneCostBuffers {
 public:
  /// Costs of plane k, rows of the target rectangle one after another.
  const float* costs(int k) const { return costs_[k].data(); }

 private:
  friend class PlaneCost;
  std::array<std::vector<float>, kPlaneBatch> costs_;
  std::vector<float> scratch_;
};

/// The data term D_p(f): the mean of the matching cost over the window of p, every pixel s matched at the disparity of
/// *this* plane at s, weighted by a guided filter (slanted support windows). References must outlive the object.
class PlaneCost {
 public:
  /// volume: entry i of a pixel is the cost of disparity range.min + i / steps, up to range.max().
  PlaneCost(const CostVolume& volume, DisparityRange range, int steps, const FilterGuide& guide,
            const PlaneCostParams& params);

  /// Evaluates every plane of the batch on every pixel of target.
  void evaluate(const PlaneBatch& batch, const cv::Rect& target, PlaneCostBuffers& buffers) const;
  /// Does the plane stay in the range around (x, y)?
  bool isValid(const Plane& plane, int x, int y) const;

 private:
  void markInvalid(const Plane& plane, const cv::Rect& target, float* costs) const;

  DisparityRange range_;
  const FilterGuide& guide_;
  PlaneCostParams params_;
  PlaneCostTask task_;
};

}  // namespace fdp_stereo::local_expansion
