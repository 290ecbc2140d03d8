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

/// What one frame leaves for the next.
struct LocalExpansion::State {
  lx::Labels left;
  lx::Labels right;  // mirrored
};

namespace {

constexpr int kLeft = 0;
constexpr int kRight = 1;

void check(const OptimizerInput& input, const LocalExpansionParams& params) {
  const cv::Size size = input.pair.left.size();
  if (size != cv::Size(input.volume.width(), input.volume.height()) || input.pair.right.size() != size) {
    throw std::invalid_argument("a cost volume of " + std::to_string(input.volume.width()) + " x " +
                                std::to_string(input.volume.height()) + " for images of " + std::to_string(size.width) +
                                " x " + std::to_string(size.height) + ": sizes must be equal");
  }
  if (params.disparity_steps > 1 && input.matching_cost == nullptr) {
    throw std::invalid_argument("disparity steps " + std::to_string(params.disparity_steps) +
                                " need the parameters of the matching cost; without them only 1 is allowed");
  }
}

cv::Mat mirrored(const cv::Mat& map) {
  cv::Mat result;
  cv::flip(map, result, 1);
  return result;
}

/// One run: the views one after the other, so that only one volume beside the given one is alive at a time.
class Run {
 public:
  Run(const OptimizerInput& input, const LocalExpansionParams& params, const OptimizerOutput& initial)
      : input_(input), params_(params), initial_(initial), stop_(input.cancel, params.max_time_ms) {}

  lx::Labels solve(int side, const lx::Labels& previous, std::vector<double>* energies) {
    lx::View view;
    CostVolume volume;
    const StereoPair pair = side == kLeft ? input_.pair : lx::mirrorPair(input_.pair);
    view.image = pair.left;
    view.range = input_.volume.range();
    view.steps = params_.disparity_steps;
    view.volume = &volume;
    if (params_.disparity_steps > 1) {
      lx::computeSubpixelVolume(pair, view.range, *input_.matching_cost, params_.disparity_steps, volume);
      spreadPriors(side, pair.left, volume);
    } else if (side == kRight) {
      lx::mirrorVolume(input_.volume, volume);
    } else {
      view.volume = &input_.volume;
    }
    view.seeds = seedsOf(side);
    const cv::Mat& initial = side == kLeft ? initial_.disparity_left : initial_.disparity_right;
    if (!initial.empty()) view.initial = side == kLeft ? initial : mirrored(initial);
    if (!previous.empty() && previous.size() == pair.left.size()) view.previous = &previous;
    view.number = static_cast<std::uint64_t>(side);
    LocalExpansionParams own = params_;
    if (side == kRight) own.iterations = params_.right_iterations;
    lx::ViewSolver solver(view, own);
    return solver.solve(stop_, [&](int round, double energy) { report(side, round, energy, energies); });
  }

 private:
  // The given volume has them already.
  void spreadPriors(int side, const cv::Mat& image, CostVolume& volume) const {
    for (const SeedPrior& prior : input_.priors) {
      Seeds seeds = prior.seeds;
      if (side == kRight) {
        for (Seed& seed : seeds) seed.x = static_cast<float>(image.cols - 1) - (seed.x - seed.d);
      }
      propagateDisparity(seeds, image, prior.params, {input_.volume.range().min, params_.disparity_steps}, volume);
    }
  }

  // In the coordinates of the view: the right one is mirrored.
  std::vector<lx::SurfacePoint> seedsOf(int side) const {
    std::vector<lx::SurfacePoint> points;
    const float last = static_cast<float>(input_.pair.left.cols - 1);
    for (const Seed& seed : input_.seeds) {
      points.push_back({side == kLeft ? seed.x : last - (seed.x - seed.d), seed.y, seed.d});
    }
    return points;
  }

  void report(int side, int round, double energy, std::vector<double>* energies) const {
    if (energies != nullptr) energies->push_back(energy);
    if (!input_.progress) return;
    const int of_left = params_.unary_iterations + params_.iterations + 1;
    const int of_right = params_.both_views ? params_.unary_iterations + params_.right_iterations + 1 : 0;
    input_.progress((side == kLeft ? 0 : of_left) + round + 1, of_left + of_right, energy);
  }

  const OptimizerInput& input_;
  const LocalExpansionParams& params_;
  const OptimizerOutput& initial_;
  const lx::StopCondition stop_;
};

/// 0 where a plane had to be filled in, else how far the data term is below its truncation.
cv::Mat confidenceOf(const lx::Labels& labels, const cv::Mat& consistent, double threshold) {
  cv::Mat result(labels.size(), CV_32FC1);
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      const bool known = consistent.empty() || consistent.at<std::uint8_t>(y, x) != 0;
      const float share = 1.0F - labels.cost[labels.index(x, y)] / static_cast<float>(threshold);
      result.at<float>(y, x) = known ? std::clamp(share, 0.0F, 1.0F) : 0.0F;
    }
  }
  return result;
}

}  // namespace

LocalExpansion::LocalExpansion(const LocalExpansionParams& params, const SemiGlobalParams& initial)
    : params_(params), initial_(initial), state_(std::make_unique<State>()) {}

LocalExpansion::~LocalExpansion() = default;

void LocalExpansion::reset() { *state_ = State{}; }

double LocalExpansion::costHeadroom() const {
  return params_.initialization == PlaneInitialization::kSemiGlobal ? SemiGlobal(initial_).costHeadroom() : 0.0;
}

double LocalExpansion::bytesPerCost() const {
  const double planes = params_.disparity_steps > 1 ? params_.disparity_steps + 1.0 : (params_.both_views ? 2.0 : 0.0);
  const double initial =
      params_.initialization == PlaneInitialization::kSemiGlobal ? SemiGlobal(initial_).bytesPerCost() : 0.0;
  return std::max(planes, initial);
}

void LocalExpansion::optimize(const OptimizerInput& input, OptimizerOutput& output) {
  check(input, params_);
  OptimizerOutput initial;
  if (params_.initialization == PlaneInitialization::kSemiGlobal) SemiGlobal(initial_).optimize(input, initial);
  if (!params_.warm_start) reset();
  output = OptimizerOutput{};
  Run run(input, params_, initial);
  lx::Labels left = run.solve(kLeft, state_->left, &output.energies);
  lx::Labels right;
  if (params_.both_views) right = run.solve(kRight, state_->right, nullptr);
  if (params_.warm_start) *state_ = State{left, right};
  cv::Mat consistent;
  if (params_.both_views) consistent = lx::consistentPixels(left, right, params_.max_difference_px);
  output.confidence = confidenceOf(left, consistent, params_.data_threshold);
  if (params_.both_views) {
    const cv::Mat consistent_right = lx::consistentPixels(right, left, params_.max_difference_px);
    lx::fillPlanes(consistent, left);
    lx::filterPlanes(input.pair.left, consistent, params_.median_radius_px, params_.median_gamma, left);
    lx::fillPlanes(consistent_right, right);  // it serves the check alone, so its holes need no median
    output.disparity_right = mirrored(lx::disparityOf(right, input.volume.range()));
  }
  output.disparity_left = lx::disparityOf(left, input.volume.range());
}

}  // namespace fdp_stereo
