// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/local_expansion.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "costs/subpixel_volume.hpp"
#include "optimizers/local_expansion/post_processing.hpp"
#include "optimizers/local_expansion/view_solver.hpp"

namespace fdp_stereo {

namespace lx = local_expansion;

namespace {

void check(const LocalExpansionInput& input, const LocalExpansionParams& params) {
  const cv::Size size = input.pair.left.size();
  if (size != cv::Size(input.volume.width(), input.volume.height()) || input.pair.right.size() != size) {
    throw std::invalid_argument("a cost volume of " + std::to_string(input.volume.width()) + " x " +
                                std::to_string(input.volume.height()) + " for images of " + std::to_string(size.width) +
                                " x " + std::to_string(size.height) + ": sizes must be equal");
  }
  if (params.disparity_steps > 1 && !input.finer_costs) {
    throw std::invalid_argument("disparity steps " + std::to_string(params.disparity_steps) +
                                " need costs between whole disparities; without them only 1 is allowed");
  }
}

/// One run: the views one after the other, so that only one volume beside the given one is alive at a time.
class Run {
 public:
  Run(const LocalExpansionInput& input, const LocalExpansionParams& params)
      : input_(input), params_(params), stop_(input.cancel, params.max_time_ms) {}

  lx::Labels solve(ExpandedView side, std::vector<double>* energies) {
    const bool left = side == ExpandedView::kLeft;
    lx::View view;
    CostVolume volume;
    view.image = left ? input_.pair.left : mirrored(input_.pair.right);
    view.range = input_.volume.range();
    view.steps = params_.disparity_steps;
    view.volume = &volume;
    if (params_.disparity_steps > 1) {
      input_.finer_costs(side, params_.disparity_steps, volume);
    } else if (left) {
      view.volume = &input_.volume;
    } else {
      mirrorVolume(input_.volume, volume);
    }
    view.seeds = seedsOf(side);
    const cv::Mat& initial = left ? input_.initial.disparity_left : input_.initial.disparity_right;
    if (!initial.empty()) view.initial = left ? initial : mirrored(initial);
    view.number = left ? 0 : 1;
    LocalExpansionParams own = params_;
    if (!left) own.iterations = params_.right_iterations;
    lx::ViewSolver solver(view, own);
    return solver.solve(stop_, [&](int round, double energy) { report(side, round, energy, energies); });
  }

 private:
  // In the coordinates of the view: the right one is mirrored.
  std::vector<lx::SurfacePoint> seedsOf(ExpandedView side) const {
    const bool left = side == ExpandedView::kLeft;
    std::vector<lx::SurfacePoint> points;
    for (const Seed& seed : left ? input_.seeds : mirrorSeeds(input_.seeds, input_.pair.left.cols)) {
      points.push_back({seed.x, seed.y, seed.d});
    }
    return points;
  }

  void report(ExpandedView side, int round, double energy, std::vector<double>* energies) const {
    if (energies != nullptr) energies->push_back(energy);
    if (!input_.progress) return;
    const int of_left = params_.unary_iterations + params_.iterations + 1;
    const int of_right = params_.both_views ? params_.unary_iterations + params_.right_iterations + 1 : 0;
    input_.progress((side == ExpandedView::kLeft ? 0 : of_left) + round + 1, of_left + of_right, energy);
  }

  const LocalExpansionInput& input_;
  const LocalExpansionParams& params_;
  const lx::StopCondition stop_;
};

/// 0 where a plane had to be filled in, else how far the data term is below its truncation, in cost units.
cv::Mat marginOf(const lx::Labels& labels, const cv::Mat& consistent, const LocalExpansionParams& params) {
  const auto threshold = static_cast<float>(params.data_threshold), scale = static_cast<float>(params.data_scale);
  cv::Mat result(labels.size(), CV_32FC1);
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      const bool known = consistent.empty() || consistent.at<std::uint8_t>(y, x) != 0;
      const float below = std::max(threshold - labels.cost[labels.index(x, y)], 0.0F);
      result.at<float>(y, x) = known ? below / scale : 0.0F;
    }
  }
  return result;
}

}  // namespace

double bytesPerCost(const LocalExpansionParams& params) {
  return params.disparity_steps > 1 ? params.disparity_steps + 1.0 : (params.both_views ? 2.0 : 0.0);
}

void expandLocally(const LocalExpansionInput& input, const LocalExpansionParams& params, OptimizerOutput& output) {
  check(input, params);
  OptimizerOutput result;
  Run run(input, params);
  lx::Labels left = run.solve(ExpandedView::kLeft, &result.energies);
  lx::Labels right;
  cv::Mat consistent;
  if (params.both_views) {
    right = run.solve(ExpandedView::kRight, nullptr);
    consistent = lx::consistentPixels(left, right, params.max_difference_px);
  }
  result.margin = marginOf(left, consistent, params);
  if (params.both_views) {
    const cv::Mat consistent_right = lx::consistentPixels(right, left, params.max_difference_px);
    lx::fillPlanes(consistent, left);
    lx::filterPlanes(input.pair.left, consistent, params.median_radius_px, params.median_gamma, left);
    lx::fillPlanes(consistent_right, right);  // it serves the check alone, so its holes need no median
    result.disparity_right = mirrored(lx::disparityOf(right, input.volume.range()));
  }
  result.disparity_left = lx::disparityOf(left, input.volume.range());
  output = std::move(result);
}

}  // namespace fdp_stereo
