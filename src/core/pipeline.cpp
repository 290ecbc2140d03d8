// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <omp.h>
#include <opencv2/imgproc.hpp>

#include "costs/subpixel_volume.hpp"
#include "fdp_stereo/confidence.hpp"
#include "fdp_stereo/hidden_pixels.hpp"
#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/scaling.hpp"
#include "images/blind_pixels.hpp"
#include "images/colour.hpp"
#include "images/cost_views.hpp"
#include "images/temporal_average.hpp"
#include "images/view_masks.hpp"
#include "refinement/view_agreement.hpp"
#include "seeds/search_tiles.hpp"
#include "simd/simd.hpp"

namespace fdp_stereo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSensorReachPx = 16;  ///< how far around a seed another sensor vouches for what the cameras do not see

/// Uses a number of threads for as long as it lives, and no more of OpenCV's. OpenCV has one number for the process.
class ThreadScope {
 public:
  explicit ThreadScope(int threads) : before_(omp_get_max_threads()), opencv_before_(cv::getNumThreads()) {
    omp_set_num_threads(threads > 0 ? threads : omp_get_num_procs());
    useOpenCvThreads(std::min(omp_get_max_threads(), opencv_before_));
  }
  ~ThreadScope() {
    omp_set_num_threads(before_);
    useOpenCvThreads(opencv_before_);
  }
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  /// Only where it changes something: OpenCV ends its threads for that, while another thread may be using them.
  static void useOpenCvThreads(int threads) {
    if (cv::getNumThreads() != threads) cv::setNumThreads(threads);
  }

  int before_, opencv_before_;
};

bool needsSemiGlobal(const PipelineParams& params) {
  return params.optimizer == OptimizerType::kSemiGlobal || params.quasi_dense.enabled ||
         (params.optimizer == OptimizerType::kLocalExpansion &&
          params.local_expansion.initialization == PlaneInitialization::kSemiGlobal);
}

/// Local expansion that reads the costs as they are gets all their bits.
CostScale costScale(const PipelineParams& params) {
  constexpr double kAllLevels = 1000.0;
  const double largest = maxMatchingCost(params.matching_cost);
  const double penalties = needsSemiGlobal(params) ? penaltiesOf(params.semi_global) : 0.0;
  const bool planes = params.optimizer == OptimizerType::kLocalExpansion && params.local_expansion.disparity_steps == 1;
  return planes ? fitCostScale(largest, penalties, kAllLevels) : fitCostScale(largest, penalties);
}

constexpr int kFewestForTiles = 97;  ///< disparities; below, tiles save less than they cost
constexpr int kRowsForTiles = 4;     ///< a tile must not be told from fewer rows

/// Is it worth while to match some rows first, and of the others only what can be there?
bool searchesTiles(const PipelineParams& params, DisparityRange search) {
  return params.optimizer == OptimizerType::kSemiGlobal && params.quasi_dense.enabled &&
         params.quasi_dense.row_step > 1 && params.quasi_dense.row_step <= SearchTiles::kRows / kRowsForTiles &&
         params.matching_cost.border == CostBorder::kRepeatDisparity && search.count >= kFewestForTiles;
}

/// Bytes that the optimiser and the quasi-dense matching need beside the volume for every cost in it.
double bytesBeside(const PipelineParams& params) {
  double bytes = params.optimizer == OptimizerType::kWinnerTakesAll ? 0.0 : SemiGlobalMatcher::kBytesPerCost;
  if (params.optimizer == OptimizerType::kLocalExpansion) {
    bytes = std::max(bytes, bytesPerCost(params.local_expansion));
  }
  return std::max(bytes,
                  params.quasi_dense.enabled ? SemiGlobalMatcher::kBytesPerCost / params.quasi_dense.row_step : 0.0);
}

void checkMemory(const PipelineParams& params, cv::Size size, DisparityRange search) {
  const double pixels = static_cast<double>(size.width) * size.height;
  const double cells = pixels * (search.count + CostVolume::kPadding);
  const double rows =
      searchesTiles(params, search) ? 1.0 / params.quasi_dense.row_step : 0.0;  // at most beside the rest
  const double own = (costScale(params).depth == CostVolume::Depth::kU8 ? 1.0 : 2.0) * (1.0 + rows);
  const double mb = cells * (own + bytesBeside(params)) / 1e6;
  if (mb <= params.max_memory_mb) return;
  throw std::invalid_argument(
      "a pair of " + std::to_string(size.width) + " x " + std::to_string(size.height) + " with " +
      std::to_string(search.count) + " disparities needs about " + std::to_string(static_cast<int>(mb)) +
      " MB, above pipeline.max_memory_mb = " + std::to_string(static_cast<int>(params.max_memory_mb)) +
      ": reduce search.num_disparities or pipeline.scale, or raise the limit");
}

constexpr float kClosedConfidence = 0.75F;  ///< at most, of a pixel that says what is around it: so many are right

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && (a.empty() || cv::norm(a, b, cv::NORM_INF) == 0.0);
}

/// The edge of a black frame is none of the scene: without it, the picture goes on to the border.
void extendPair(StereoPair& pair) {
  const auto extend = [](cv::Mat& image, cv::Mat& grey) {
    const cv::Mat frame = blackFrame(grey);
    const bool shared = image.data == grey.data;
    image = extendUnder(frame, image);
    grey = shared ? image : extendUnder(frame, grey);
  };
  extend(pair.left, pair.left_grey);
  extend(pair.right, pair.right_grey);
}

/// Filters the regions of what is seen, and keeps of the rest what that explains.
void dropUnseen(const cv::Mat& blind, const SeenViews& views, const SpeckleFilterParams& speckles, cv::Mat& disparity) {
  const cv::Mat guessed = disparity.clone();
  disparity.setTo(kInvalidDisparity, blind);
  filterRegions(views, speckles, disparity);
  guessed.copyTo(disparity, blind);
  dropUnexplained(blind, disparity);
}

void dropFeatures(Seeds& seeds) {
  const auto is_feature = [](const Seed& seed) { return seed.source == SeedSource::kFeature; };
  seeds.erase(std::remove_if(seeds.begin(), seeds.end(), is_feature), seeds.end());
}

/// A result whose maps the caller may change.
PipelineResult copyOf(const PipelineResult& result) {
  PipelineResult copy = result;
  for (cv::Mat* map : {&copy.disparity, &copy.confidence, &copy.sigma}) *map = map->clone();
  return copy;
}

}  // namespace

SparseDisparity allSeeds(const PipelineResult& result) {
  SparseDisparity all{result.quasi_dense_seeds, result.rejected_seeds};
  all.seeds.insert(all.seeds.end(), result.seeds.begin(), result.seeds.end());  // last, so that they are on top
  return all;
}

/// Times one stage after another; one that works twice has one time.
class Pipeline::StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& times) : times_(times), start_(Clock::now()) {}
  void done(const char* stage) {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    const auto known = std::find_if(times_.begin(), times_.end(), [&](const StageTime& t) { return t.stage == stage; });
    if (known == times_.end()) {
      times_.push_back({stage, ms});
    } else {
      known->ms += ms;
    }
    start_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  Clock::time_point start_;
};

/// What is kept from pair to pair.
struct Pipeline::State {
  ViewMasks masks;  ///< of the images as given
  cv::Size size;    ///< of the last pair as it was given
  int type = -1;
  ValueRange values;
  TemporalAverage average;
  PipelineResult last;       ///< of the pair before in a stream
  bool last_counts = false;  ///< it is that of the images alone, and whole
  Quality last_quality = Quality::kNone;
  RowAlignmentAccumulator row_alignment;
  MatchingCost matching_cost;
  CostVolume rows;  ///< that are matched first, where tiles are searched
  CostVolume volume;
  SemiGlobalMatcher semi_global;
};

/// What the stages of one run hand on.
struct Pipeline::Frame {
  StereoPair pair;  ///< of the size that is matched; the right view aligned
  CostViews cost;   ///< the same, as the matching cost sees it
  DisparityRange search;
  cv::Mat guide;    ///< left, CV_8UC1
  cv::Mat blind;    ///< CV_8UC1, 255 where the left view holds no information
  cv::Mat vouched;  ///< CV_8UC1, 255 where another sensor has seen something; empty without one
  ViewMasks masks;
  RoughDisparity rough;
  OptimizerOutput optimized;
};

Pipeline::Pipeline(const PipelineParams& params) : state_(std::make_unique<State>()) {
  checkWantedSimdLevel();
  setParams(params);
}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

void Pipeline::setParams(const PipelineParams& params) {
  validate(params);
  params_ = params;
  state_->average.reset("new parameters");
}

void Pipeline::setScale(double scale) {
  PipelineParams params = params_;
  params.scale = scale;
  validate(params);
  params_ = params;
  state_->last = {};  // at the other scale
  state_->last_counts = false;
}

void Pipeline::setStream(bool stream) {
  if (stream != stream_) state_->average.reset("a stream begins");
  stream_ = stream;
}

void Pipeline::reset(const std::string& reason) {
  state_->row_alignment.reset();
  state_->values = {};
  resetStream(reason);
}

void Pipeline::resetStream(const std::string& reason) { state_->average.reset(reason); }

void Pipeline::setMasks(const cv::Mat& left, const cv::Mat& right) {
  if (equal(left, state_->masks.left) && equal(right, state_->masks.right)) return;
  state_->masks = {left.clone(), right.clone()};
  resetStream("new masks");
}

/// What lies under the masks is replaced by what is beside them: nothing depends on it.
StereoPair Pipeline::prepare(const cv::Mat& left, const cv::Mat& right) {
  checkMask(state_->masks.left, left.size(), "left mask");
  checkMask(state_->masks.right, right.size(), "right mask");
  if (left.size() != state_->size || left.type() != state_->type) state_->values = {};
  state_->size = left.size();
  state_->type = left.type();
  return prepareImages(extendUnder(state_->masks.left, left), extendUnder(state_->masks.right, right), state_->values);
}

PipelineResult Pipeline::run(const cv::Mat& left, const cv::Mat& right, const Seeds& external,
                             const std::atomic<bool>* cancel) {
  const ThreadScope threads(params_.threads);
  PipelineResult result;
  StageClock clock(result.times);
  StereoPair given = prepare(left, right);
  result.left = given.left;
  clock.done("image_preparation");
  if (!stream_ || !params_.temporal.enabled) {
    compute(given, external, cancel, clock, result);
    return result;
  }
  const TemporalAverage::Outcome outcome = state_->average.update(given);
  const bool same = !outcome.changed && state_->last_counts && external.empty();
  result.temporal = {outcome.kept_share, same && quality_ == state_->last_quality, outcome.reset};
  clock.done("temporal");
  if (result.temporal.repeated) return repeat(std::move(result));
  state_->last_counts = false;
  compute(given, external, cancel, clock, result);
  if (same) {
    state_->last.disparity.copyTo(result.disparity);  // only its quality was not known yet
  } else {
    state_->average.steady(state_->last.disparity, result.disparity);
  }
  state_->last = copyOf(result);
  state_->last_counts = external.empty() && !(cancel != nullptr && *cancel);
  state_->last_quality = quality_;
  return result;
}

/// The result of the pair before, with what this pair alone tells.
PipelineResult Pipeline::repeat(PipelineResult now) const {
  PipelineResult result = copyOf(state_->last);
  result.left = std::move(now.left);
  result.temporal = std::move(now.temporal);
  result.times = std::move(now.times);
  return result;
}

/// All stages from the features on.
void Pipeline::compute(const StereoPair& given, const Seeds& external, const std::atomic<bool>* cancel,
                       StageClock& clock, PipelineResult& result) {
  const Scaling scaling(given.left.size(), params_.scale);
  Frame frame{scaling.shrink(given), {}, scaling.shrink(params_.search), {}, {}, {}, {}, {}, {}};
  frame.masks = shrinkMasks(state_->masks, frame.pair.left.size());
  checkMemory(params_, frame.pair.left.size(), frame.search);
  frame.blind = blindPixels(frame.pair.left_grey);
  extendPair(frame.pair);
  clock.done("image_preparation");

  FeatureMatching features = matchFeatures(frame.pair, frame.search, params_.feature_matching);
  dropMasked(frame.masks, features.matches);
  result.matches = std::move(features.matches);
  result.feature_note = std::move(features.note);
  clock.done("feature_matching");

  result.row_alignment = alignPair(result.matches, given.left.rows, frame);
  clock.done("row_alignment");

  frame.cost = costViews(frame.pair, params_.matching_cost);
  const bool tiled = searchesTiles(params_, frame.search);
  const int row_step = tiled ? params_.quasi_dense.row_step : 1;
  CostVolume& rows = tiled ? state_->rows : state_->volume;
  state_->matching_cost.compute(frame.cost.pair, frame.search, frame.cost.params, costScale(params_), rows, row_step);
  clock.done("matching_cost");

  buildSeeds(frame, scaling.shrink(external), rows, result);
  clock.done("sparse_disparity");

  if (tiled) {
    const SearchTiles tiles = findSearchTiles(frame.rough, result.seeds, frame.guide.size(), frame.search, row_step);
    state_->matching_cost.complete(frame.cost.pair, frame.cost.params, tiles, rows, row_step, state_->volume);
    clock.done("matching_cost");
  }

  result.propagated_share = spreadSeeds(result, frame.pair.left, false, {frame.search.min, 1}, state_->volume);
  clock.done("disparity_propagation");

  optimize(frame, result, cancel);
  clock.done("optimizer");

  refine(frame, result);
  if (!scaling.identity()) restoreSize(scaling, frame.pair.left, given.left, result);
  if (!state_->masks.left.empty()) dropMasked({state_->masks.left, {}}, result.disparity);
  clock.done("refinement");
}

RowAlignment Pipeline::alignPair(const FeatureMatches& matches, int given_rows, Frame& frame) {
  if (!params_.row_alignment.enabled) return {};
  StereoPair& pair = frame.pair;
  const cv::Size size = pair.left.size();
  const double given_px = static_cast<double>(given_rows) / size.height;
  RowAlignment alignment = state_->row_alignment.update(matches, size, params_.row_alignment, given_px);
  const bool shared = pair.right.data == pair.right_grey.data;
  pair.right = alignRows(pair.right, alignment.model);
  pair.right_grey = shared ? pair.right : alignRows(pair.right_grey, alignment.model);
  if (!frame.masks.right.empty()) frame.masks.right = alignRows(frame.masks.right, alignment.model);
  return alignment;
}

/// Seeds of the features and of other sensors, and those of a rough first matching.
void Pipeline::buildSeeds(Frame& frame, Seeds external, const CostVolume& rows, PipelineResult& result) {
  dropMasked({frame.masks.left, {}}, external);  // another sensor sees behind what hides it from the right view

  const bool features = params_.sparse_disparity.features;
  FeatureMatches aligned;  // they vouch for the seeds of other sensors too
  if (features || !external.empty()) aligned = alignMatches(result.matches, result.row_alignment.model);
  SparseDisparity sparse = buildSparseDisparity(aligned, external, frame.pair, frame.search, params_.sparse_disparity);
  result.seeds = std::move(sparse.seeds);
  result.rejected_seeds = std::move(sparse.rejected);
  if (!features) dropFeatures(result.seeds);
  cv::Mat buffer;
  frame.guide = eightBitGrey(frame.pair.left, frame.pair.left_grey, buffer);
  for (const Seed& seed : result.seeds) {  // another sensor sees where the cameras do not
    if (seed.source == SeedSource::kFeature) continue;
    if (frame.vouched.empty()) frame.vouched = cv::Mat::zeros(frame.guide.size(), CV_8UC1);
    cv::circle(frame.vouched, cv::Point(cvRound(seed.x), cvRound(seed.y)), kSensorReachPx, cv::Scalar(255), cv::FILLED);
  }
  if (!frame.vouched.empty()) frame.blind.setTo(0, frame.vouched);
  if (!frame.masks.left.empty()) frame.blind.setTo(255, frame.masks.left);
  if (!params_.quasi_dense.enabled) return;
  frame.rough = matchRoughly(rows, frame.guide, params_.quasi_dense, params_.semi_global, state_->semi_global);
  result.quasi_dense_seeds = quasiDenseSeeds(frame.rough, frame.guide.size(), params_.quasi_dense);
  dropMasked(frame.masks, result.quasi_dense_seeds);
}

/// Spreads the seeds in the costs of a view; returns the share of the pixels whose costs they changed.
double Pipeline::spreadSeeds(const PipelineResult& result, const cv::Mat& view, bool mirrored, DisparityAxis axis,
                             CostVolume& volume) const {
  const auto spread = [&](const Seeds& seeds, const DisparityPropagationParams& params) {
    return mirrored ? propagateDisparity(mirrorSeeds(seeds, view.cols), view, params, axis, volume)
                    : propagateDisparity(seeds, view, params, axis, volume);
  };
  const double share = spread(result.seeds, params_.disparity_propagation);
  if (!params_.quasi_dense.enabled) return share;
  return std::max(share, spread(result.quasi_dense_seeds, surfacesOf(params_.quasi_dense)));
}

void Pipeline::optimize(Frame& frame, PipelineResult& result, const std::atomic<bool>* cancel) {
  switch (params_.optimizer) {
    case OptimizerType::kWinnerTakesAll:
      return takeWinners(state_->volume, params_.winner_takes_all, frame.optimized);
    case OptimizerType::kSemiGlobal:
      return state_->semi_global.match(state_->volume, frame.guide, params_.semi_global, frame.optimized);
    case OptimizerType::kLocalExpansion:
      return expandPlanes(frame, result, cancel);
  }
}

/// Local expansion from the disparities of semi-global matching, on costs between whole disparities.
void Pipeline::expandPlanes(Frame& frame, PipelineResult& result, const std::atomic<bool>* cancel) {
  OptimizerOutput initial;
  if (params_.local_expansion.initialization == PlaneInitialization::kSemiGlobal) {
    state_->semi_global.match(state_->volume, frame.guide, params_.semi_global, initial);
  }
  const auto finer_costs = [&](ExpandedView side, int steps, CostVolume& volume) {
    const bool mirrored = side == ExpandedView::kRight;
    const StereoPair pair = mirrored ? mirrorPair(frame.pair) : frame.pair;
    const StereoPair& seen = frame.cost.pair;
    computeSubpixelVolume(mirrored ? mirrorPair(seen) : seen, frame.search, frame.cost.params, steps, volume);
    spreadSeeds(result, pair.left, mirrored, {frame.search.min, steps}, volume);
  };
  const LocalExpansionInput input{state_->volume, frame.pair, result.seeds, initial, finer_costs, cancel, progress_};
  expandLocally(input, params_.local_expansion, frame.optimized);
  result.energies = frame.optimized.energies;
}

/// What is not known goes; the rest is filtered, and filled where that is wanted.
void Pipeline::refine(Frame& frame, PipelineResult& result) const {
  cv::Mat& disparity = frame.optimized.disparity_left;
  const cv::Mat& left = frame.pair.left;
  const cv::Mat roughness = quality_ == Quality::kNone ? cv::Mat() : disparityRoughness(disparity);
  dropHidden(disparity);
  dropMasked(frame.masks, disparity);
  if (params_.left_right_check.enabled && !frame.optimized.disparity_right.empty()) {
    checkLeftRight(disparity, frame.optimized.disparity_right, params_.left_right_check);
  }
  cv::Mat seen = params_.hole_filling.enabled ? disparity.clone() : disparity;
  cv::Mat buffer;
  const SeenViews views{frame.guide, eightBitGrey(frame.pair.right, frame.pair.right_grey, buffer), frame.vouched};
  dropUnseen(frame.blind, views, params_.speckle_filter, seen);
  if (params_.hole_filling.enabled) {  // what is guessed helps to fill, but is not known
    filterSpeckles(disparity, params_.speckle_filter);
    frame.blind |= noneMask(seen) & (disparity == disparity);
  }
  const cv::Mat closed = params_.hole_closing.enabled ? closeHoles(disparity) : cv::Mat();
  judge(frame, roughness, closed, result);
  if (params_.hole_filling.enabled) fillHoles(disparity, params_.hole_filling.max_size);
  filterWeightedMedian(disparity, left, params_.weighted_median);
  smoothDisparity(disparity, left, params_.disparity_smoothing);
  result.disparity = disparity;
}

/// What is filled in afterwards has no confidence.
void Pipeline::judge(const Frame& frame, const cv::Mat& roughness, const cv::Mat& closed,
                     PipelineResult& result) const {
  if (quality_ == Quality::kNone) return;
  const OptimizerOutput& optimized = frame.optimized;
  const QualityInput input{roughness,   optimized.margin, optimized.disparity_left, optimized.disparity_right,
                           frame.guide, frame.search};
  DisparityQuality quality = judgeDisparity(input, quality_ == Quality::kWithMeasures);
  result.confidence = quality.confidence;
  result.sigma = quality.sigma;
  result.quality_measures = std::move(quality.measures);
  if (!closed.empty()) result.confidence.setTo(kClosedConfidence, closed & (result.confidence > kClosedConfidence));
  result.confidence.setTo(0.0F, frame.blind);
  result.sigma.setTo(kInvalidDisparity, frame.blind);
}

void Pipeline::restoreSize(const Scaling& scaling, const cv::Mat& matched, const cv::Mat& given,
                           PipelineResult& result) const {
  result.disparity = scaling.grow(result.disparity, matched, given, params_.search);
  if (!result.confidence.empty()) {
    const cv::Mat none = noneMask(result.disparity);
    const double growth = static_cast<double>(given.cols) / matched.cols;
    cv::resize(result.confidence, result.confidence, given.size(), 0.0, 0.0, cv::INTER_NEAREST);
    cv::resize(result.sigma * growth, result.sigma, given.size(), 0.0, 0.0, cv::INTER_NEAREST);
    result.confidence.setTo(0.0F, none);
    result.sigma.setTo(kInvalidDisparity, none);
  }
  result.matches = scaling.grow(std::move(result.matches));
  result.seeds = scaling.grow(std::move(result.seeds));
  result.quasi_dense_seeds = scaling.grow(std::move(result.quasi_dense_seeds));
  result.rejected_seeds = scaling.grow(std::move(result.rejected_seeds));
  result.row_alignment = scaling.grow(std::move(result.row_alignment));
}

}  // namespace fdp_stereo
