// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <omp.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/scaling.hpp"
#include "simd/simd.hpp"

namespace fdp_stereo {
namespace {

using Clock = std::chrono::steady_clock;

/// Times one stage after another.
class StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& times) : times_(times), start_(Clock::now()) {}
  void done(const char* stage) {
    const auto now = Clock::now();
    times_.push_back({stage, std::chrono::duration<double, std::milli>(now - start_).count()});
    start_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  Clock::time_point start_;
};

/// Uses a number of OpenMP threads for as long as it lives.
class ThreadScope {
 public:
  explicit ThreadScope(int threads) : before_(omp_get_max_threads()) {
    omp_set_num_threads(threads > 0 ? threads : omp_get_num_procs());
  }
  ~ThreadScope() { omp_set_num_threads(before_); }
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  int before_;
};

std::unique_ptr<Optimizer> makeOptimizer(const PipelineParams& params) {
  switch (params.optimizer) {
    case OptimizerType::kWinnerTakesAll:
      return std::make_unique<WinnerTakesAll>(params.winner_takes_all);
    case OptimizerType::kSemiGlobal:
      return std::make_unique<SemiGlobal>(params.semi_global);
    case OptimizerType::kLocalExpansion:
      return std::make_unique<LocalExpansion>(params.local_expansion, params.semi_global);
  }
  throw std::invalid_argument("optimizer.type " + std::to_string(static_cast<int>(params.optimizer)) + ": unknown");
}

/// Are the parameters of the optimizer and its choice the same?
bool sameOptimizer(PipelineParams a, PipelineParams b) {
  const std::vector<ParamRef> first = paramList(a);
  const std::vector<ParamRef> second = paramList(b);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::string stage = first[i].key.substr(0, first[i].key.find('.'));
    const bool counts =
        stage == "optimizer" || stage == "winner_takes_all" || stage == "semi_global" || stage == "local_expansion";
    if (counts && toString(first[i]) != toString(second[i])) return false;
  }
  return true;
}

bool wantsQuasiDense(const PipelineParams& params) {
  return params.disparity_propagation.enabled && params.quasi_dense.enabled;
}

/// The finest cost step with which a path cost still fits the bits of the volume.
float costStep(const PipelineParams& params, const Optimizer& optimizer) {
  const double steps = params.matching_cost.bits == 8 ? 252.0 : 8188.0;
  double headroom = optimizer.costHeadroom();
  if (wantsQuasiDense(params)) headroom = std::max(headroom, SemiGlobal(params.semi_global).costHeadroom());
  return static_cast<float>((maxMatchingCost(params.matching_cost) + headroom) / steps);
}

void checkMemory(const PipelineParams& params, const Optimizer& optimizer, cv::Size size, DisparityRange search) {
  const double pixels = static_cast<double>(size.width) * size.height;
  const double cells = pixels * (search.count + CostVolume::kPadding);
  double beside = optimizer.bytesPerCost();
  if (wantsQuasiDense(params)) {
    beside = std::max(beside, SemiGlobal(params.semi_global).bytesPerCost() / params.quasi_dense.row_step);
  }
  const double mb = cells * (params.matching_cost.bits / 8.0 + beside) / 1e6;
  if (mb <= params.max_memory_mb) return;
  throw std::invalid_argument(
      "a pair of " + std::to_string(size.width) + " x " + std::to_string(size.height) + " with " +
      std::to_string(search.count) + " disparities needs about " + std::to_string(static_cast<int>(mb)) +
      " MB, above pipeline.max_memory_mb = " + std::to_string(static_cast<int>(params.max_memory_mb)) +
      ": reduce search.num_disparities or raise the limit");
}

}  // namespace

SparseDisparity allSeeds(const PipelineResult& result) {
  SparseDisparity all{result.quasi_dense_seeds, result.rejected_seeds};
  all.seeds.insert(all.seeds.end(), result.seeds.begin(), result.seeds.end());  // last, so that they are on top
  return all;
}

struct Pipeline::Buffers {
  MatchingCost matching_cost;
  CostVolume volume;
};

Pipeline::Pipeline(const PipelineParams& params) : buffers_(std::make_unique<Buffers>()) {
  checkWantedSimdLevel();
  setParams(params);
}
Pipeline::~Pipeline() = default;

void Pipeline::setParams(const PipelineParams& params) {
  validate(params);
  // An optimizer that stays keeps what it has learnt from earlier frames.
  if (!optimizer_ || !sameOptimizer(params_, params)) optimizer_ = makeOptimizer(params);
  params_ = params;
}

void Pipeline::reset() {
  row_alignment_.reset();
  optimizer_->reset();
}

PipelineResult Pipeline::run(const cv::Mat& left, const cv::Mat& right, const Seeds& external,
                             const std::atomic<bool>* cancel) {
  const ThreadScope threads(params_.threads);
  PipelineResult result;
  StageClock clock(result.times);
  StereoPair pair = prepareImages(left, right);
  const cv::Mat given_left = pair.left;
  const Scaling scaling(given_left.size(), params_.scale);
  pair = scaling.shrink(pair);
  const DisparityRange search = scaling.shrink(params_.search);
  checkMemory(params_, *optimizer_, pair.left.size(), search);
  clock.done("image_preparation");

  FeatureMatching features = matchFeatures(pair, search, params_.feature_matching);
  result.matches = std::move(features.matches);
  result.feature_note = std::move(features.note);
  clock.done("feature_matching");

  result.row_alignment = alignPair(result.matches, pair);
  clock.done("row_alignment");

  CostVolume& volume = buffers_->volume;
  buffers_->matching_cost.compute(pair, search, params_.matching_cost, costStep(params_, *optimizer_), volume);
  clock.done("matching_cost");

  const FeatureMatches aligned = alignMatches(result.matches, result.row_alignment.model);
  SparseDisparity sparse =
      buildSparseDisparity(aligned, scaling.shrink(external), pair, search, params_.sparse_disparity);
  result.seeds = std::move(sparse.seeds);
  result.rejected_seeds = std::move(sparse.rejected);
  clock.done("sparse_disparity");

  std::vector<SeedPrior> priors;
  if (params_.disparity_propagation.enabled) {
    priors.push_back({result.seeds, params_.disparity_propagation});
    result.propagated_share = propagateDisparity(result.seeds, pair.left, params_.disparity_propagation, volume);
  }
  clock.done("disparity_propagation");

  if (wantsQuasiDense(params_)) {
    result.quasi_dense_seeds = matchQuasiDense(pair, volume);
    clock.done("quasi_dense_matching");
    priors.push_back({result.quasi_dense_seeds, surfacesOf(params_.quasi_dense)});
    const double share = propagateDisparity(result.quasi_dense_seeds, pair.left, priors.back().params, volume);
    result.propagated_share = std::max(result.propagated_share, share);
    clock.done("quasi_dense_propagation");
  }

  OptimizerOutput optimized;  // its maps become those of the result
  optimizer_->optimize({volume, pair, result.seeds, cancel, &params_.matching_cost, progress_, priors}, optimized);
  result.energies = optimized.energies;
  clock.done("optimizer");

  pair = {pair.left, {}, {}, {}};  // the other images are not needed any more
  postProcess(pair.left, optimized, result);
  if (!scaling.identity()) restoreSize(scaling, pair.left, given_left, result);
  clock.done("post_processing");
  return result;
}

Seeds Pipeline::matchQuasiDense(const StereoPair& pair, const CostVolume& volume) {
  if (auto* shared = dynamic_cast<SemiGlobal*>(optimizer_.get())) {  // one set of buffers for both
    return quasiDenseSeeds(volume, pair, params_.quasi_dense, *shared);
  }
  SemiGlobal own(params_.semi_global);
  return quasiDenseSeeds(volume, pair, params_.quasi_dense, own);
}

RowAlignment Pipeline::alignPair(const FeatureMatches& matches, StereoPair& pair) {
  if (!params_.row_alignment.enabled) return {};
  const cv::Size size = pair.left.size();
  RowAlignment alignment = row_alignment_.update(matches, size, params_.row_alignment);
  const bool shared = pair.right.data == pair.right_grey.data;
  pair.right = alignRows(pair.right, alignment.model);
  pair.right_grey = shared ? pair.right : alignRows(pair.right_grey, alignment.model);
  return alignment;
}

void Pipeline::postProcess(const cv::Mat& left, OptimizerOutput& optimized, PipelineResult& result) const {
  cv::Mat& disparity = optimized.disparity_left;
  if (params_.left_right_check.enabled && !optimized.disparity_right.empty()) {
    checkLeftRight(disparity, optimized.disparity_right, params_.left_right_check);
  }
  optimized.disparity_right.release();
  filterSpeckles(disparity, params_.speckle_filter);
  const cv::Mat holes = ~(disparity == disparity);  // OpenCV finds no NaN by != where it compares vectors
  if (params_.hole_filling.enabled) fillHoles(disparity);
  filterWeightedMedian(disparity, left, holes, params_.weighted_median);
  smoothDisparity(disparity, left, params_.disparity_smoothing);
  result.disparity = disparity;
  result.confidence = optimized.confidence;
  result.confidence.setTo(0.0F, ~(disparity == disparity));
}

void Pipeline::restoreSize(const Scaling& scaling, const cv::Mat& matched, const cv::Mat& given,
                           PipelineResult& result) const {
  result.disparity = scaling.grow(result.disparity, matched, given, params_.search);
  cv::resize(result.confidence, result.confidence, given.size(), 0.0, 0.0, cv::INTER_LINEAR);
  result.confidence.setTo(0.0F, ~(result.disparity == result.disparity));
  result.matches = scaling.grow(std::move(result.matches));
  result.seeds = scaling.grow(std::move(result.seeds));
  result.quasi_dense_seeds = scaling.grow(std::move(result.quasi_dense_seeds));
  result.rejected_seeds = scaling.grow(std::move(result.rejected_seeds));
  result.row_alignment = scaling.grow(std::move(result.row_alignment));
}

}  // namespace fdp_stereo
