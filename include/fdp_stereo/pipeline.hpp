// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {

class Scaling;

/// What one run tells of itself.
struct PipelineStats {
  std::string feature_note;  ///< why another detector than the wanted one ran; empty otherwise
  TemporalReport temporal;
  RowAlignment row_alignment;
  double propagated_share = 0.0;  ///< share of the pixels whose costs the seeds changed
  std::vector<double> energies;   ///< of the optimiser, per iteration
  std::vector<StageTime> times;   ///< in the order of the stages
};

/// All that one run found.
struct PipelineResult : PipelineStats {
  cv::Mat disparity;   ///< CV_32FC1, px of the left image as given, NaN = none
  cv::Mat confidence;  ///< CV_32FC1, 0..1: probability that the disparity is off by at most 1 px; 0 = filled or none
  cv::Mat sigma;       ///< CV_32FC1, px: standard deviation of the disparity, NaN where the confidence is 0
  std::vector<cv::Mat> quality_measures;  ///< what confidence and sigma come from, where setQuality() asks for them
  cv::Mat left;  ///< CV_8UC1 or CV_8UC3, the left image in 8 bits; shares the one given where that is so
  FeatureMatches matches;
  Seeds seeds;
  Seeds rejected_seeds;
  Seeds quasi_dense_seeds;  ///< of the first matching, where that is enabled
};

/// What drawSeeds() shows of a result.
SparseDisparity allSeeds(const PipelineResult& result);

/// The method: stages 1 to 8, one after another. Owns their buffers; one instance per thread.
class Pipeline {
 public:
  enum class Quality { kNone, kEstimated, kWithMeasures };

  /// Throws std::invalid_argument where validate() does.
  explicit Pipeline(const PipelineParams& params);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Disparity of a rectified pair: 8U or 16U, 1 or 3 (BGR) channels, equal sizes; never modified. external: seeds
  /// from other sensors. cancel: may be set from another thread; the run then ends soon with what it has.
  /// Throws std::invalid_argument for images that do not fit together or a range beyond max_memory_mb.
  PipelineResult run(const cv::Mat& left, const cv::Mat& right, const Seeds& external = {},
                     const std::atomic<bool>* cancel = nullptr);

  /// Takes effect with the next run; keeps buffers and what was learnt from earlier frames where that still fits.
  void setParams(const PipelineParams& params);
  /// Another params().scale alone, which the memory of the stream outlives.
  void setScale(double scale);
  const PipelineParams& params() const { return params_; }
  /// Called after every step of an optimiser that takes long, from the thread of run(); empty = nobody is told.
  void setProgress(OptimizerProgress progress) { progress_ = std::move(progress); }
  /// Confidence and sigma are estimated unless nobody wants them: they are empty then.
  void setQuality(Quality quality) { quality_ = quality; }
  /// Pixels to leave out of the next runs, in each image as given (the robot's body, dirt, a border): CV_8UC1, not 0 =
  /// left out; empty = none. They are neither matched nor seeds, have no disparity though holes are filled, and what
  /// they show has no influence on the others.
  void setMasks(const cv::Mat& left, const cv::Mat& right);
  /// The pairs to come follow one another before one camera: temporal.enabled averages what stands still. Otherwise
  /// each pair is one by itself.
  void setStream(bool stream);
  /// Forgets what was learnt from earlier frames: row alignment, range of 16-bit values, the memory of the stream.
  /// reason: what TemporalReport::reset says of the next pair.
  void reset(const std::string& reason = "asked for");
  /// Forgets the memory of the stream alone.
  void resetStream(const std::string& reason);

 private:
  struct State;
  struct Frame;
  class StageClock;
  StereoPair prepare(const cv::Mat& left, const cv::Mat& right);
  PipelineResult repeat(PipelineResult now) const;
  void compute(const StereoPair& given, const Seeds& external, const std::atomic<bool>* cancel, StageClock& clock,
               PipelineResult& result);
  RowAlignment alignPair(const FeatureMatches& matches, int given_rows, Frame& frame);
  void buildSeeds(Frame& frame, Seeds external, const CostVolume& rows, PipelineResult& result);
  double spreadSeeds(const PipelineResult& result, const cv::Mat& view, bool mirrored, DisparityAxis axis,
                     CostVolume& volume) const;
  void optimize(Frame& frame, PipelineResult& result, const std::atomic<bool>* cancel);
  void expandPlanes(Frame& frame, PipelineResult& result, const std::atomic<bool>* cancel);
  void refine(Frame& frame, PipelineResult& result) const;
  void judge(const Frame& frame, const cv::Mat& roughness, const cv::Mat& closed, PipelineResult& result) const;
  void restoreSize(const Scaling& scaling, const cv::Mat& matched, const cv::Mat& given, PipelineResult& result) const;

  PipelineParams params_;
  OptimizerProgress progress_;
  Quality quality_ = Quality::kEstimated;
  bool stream_ = false;
  std::unique_ptr<State> state_;
};

}  // namespace fdp_stereo
