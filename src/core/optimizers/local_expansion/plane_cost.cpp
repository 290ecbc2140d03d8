// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/plane_cost.hpp"

#include <algorithm>
#include <cmath>

namespace fdp_stereo::local_expansion {

PlaneCost::PlaneCost(const CostVolume& volume, DisparityRange range, int steps, const FilterGuide& guide,
                     const PlaneCostParams& params)
    : range_(range), guide_(guide), params_(params), task_{} {
  const bool bytes = volume.depth() == CostVolume::Depth::kU8;
  task_.volume8 = bytes ? volume.at<std::uint8_t>(0, 0) : nullptr;
  task_.volume16 = bytes ? nullptr : volume.at<std::uint16_t>(0, 0);
  task_.stride = volume.stride();
  task_.entries = (range.count - 1) * steps + 1;
  task_.first = static_cast<float>(range.min);
  task_.entries_per_px = static_cast<float>(steps);
  task_.scale = static_cast<float>(params.scale) * volume.step();
  task_.threshold = static_cast<float>(params.threshold);
  task_.image_width = volume.width();
  task_.image_height = volume.height();
  task_.radius = guide.radius;
  task_.guide = guide.channels.data();
  task_.inverse = guide.inverse.data();
}

void PlaneCost::evaluate(const PlaneBatch& batch, const cv::Rect& target, PlaneCostBuffers& buffers) const {
  const LocalExpansionKernels& kernels = FDP_STEREO_SELECT(localExpansionKernels);
  PlaneCostTask task = task_;
  task.x0 = target.x;
  task.y0 = target.y;
  task.width = target.width;
  task.height = target.height;
  for (int k = 0; k < kPlaneBatch; ++k) {
    task.a[k] = batch[k].a;
    task.b[k] = batch[k].b;
    task.c[k] = batch[k].c;
    buffers.costs_[k].resize(std::max(buffers.costs_[k].size(), static_cast<std::size_t>(target.area())));
    task.out[k] = buffers.costs_[k].data();
  }
  const std::size_t scratch = kernels.planeCostScratch(target.width, guide_.radius);
  buffers.scratch_.resize(std::max(buffers.scratch_.size(), scratch));
  task.scratch = buffers.scratch_.data();
  kernels.planeCosts(task);
  for (int k = 0; k < kPlaneBatch; ++k) markInvalid(batch[k], target, task.out[k]);
}

bool PlaneCost::isValid(const Plane& plane, int x, int y) const {
  const float reach = static_cast<float>(params_.margin_px) * (std::fabs(plane.a) + std::fabs(plane.b));
  const float d = plane.at(x, y);
  return d - reach >= static_cast<float>(range_.min) && d + reach <= static_cast<float>(range_.max());
}

void PlaneCost::markInvalid(const Plane& plane, const cv::Rect& target, float* costs) const {
  // A plane takes its extremes in the corners.
  const int right = target.x + target.width - 1;
  const int below = target.y + target.height - 1;
  if (isValid(plane, target.x, target.y) && isValid(plane, right, target.y) && isValid(plane, target.x, below) &&
      isValid(plane, right, below)) {
    return;
  }
  for (int y = target.y; y <= below; ++y) {
    for (int x = target.x; x <= right; ++x, ++costs) {
      if (!isValid(plane, x, y)) *costs = kInvalidCost;
    }
  }
}

}  // namespace fdp_stereo::local_expansion
