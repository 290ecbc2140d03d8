// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <vector>

#include "fdp_stereo/local_expansion.hpp"
#include "optimizers/local_expansion/expansion_move.hpp"
#include "optimizers/local_expansion/guided_filter.hpp"
#include "optimizers/local_expansion/labels.hpp"
#include "optimizers/local_expansion/layers.hpp"
#include "optimizers/local_expansion/plane_cost.hpp"
#include "optimizers/local_expansion/proposers.hpp"
#include "optimizers/local_expansion/seed_planes.hpp"
#include "optimizers/local_expansion/smoothness.hpp"

namespace fdp_stereo::local_expansion {

/// Says when to stop: cancelled from another thread, or out of time.
class StopCondition {
 public:
  /// cancel may be null; max_time_ms 0 = no limit, counted from now.
  StopCondition(const std::atomic<bool>* cancel, double max_time_ms);
  bool reached() const;

 private:
  const std::atomic<bool>* cancel_;
  bool limited_;
  std::chrono::steady_clock::time_point end_;
};

/// One view of a pair: image, costs, and what is known of its planes beforehand.
struct View {
  cv::Mat image;  ///< CV_8UC1 or CV_8UC3
  const CostVolume* volume = nullptr;
  DisparityRange range;
  int steps = 1;                    ///< entries of the volume per px
  cv::Mat initial;                  ///< CV_32FC1 disparities (NaN = none) to start from, or empty
  std::vector<SurfacePoint> seeds;  ///< sparse disparities, real-valued positions
  std::uint64_t number = 0;         ///< keeps the random numbers of the views apart
};

/// Finds the planes of one view. `report` is called with the number of finished rounds and the energy.
class ViewSolver {
 public:
  using Report = std::function<void(int, double)>;
  /// view must outlive the solver.
  ViewSolver(const View& view, const LocalExpansionParams& params);
  ~ViewSolver();
  /// Labels of the view after all rounds, or when `stop` was reached (then at least initialised).
  Labels solve(const StopCondition& stop, const Report& report);

 private:
  struct Worker;
  using Candidates = std::vector<Plane>;

  void initialize(Labels& labels);
  Candidates initialPlanes(const Cell& cell, Worker& worker, Random& random) const;
  template <typename Use>
  void evaluate(const Candidates& planes, const cv::Rect& area, PlaneCostBuffers& buffers, const Use& use) const;
  void choose(const Candidates& planes, const Cell& cell, Worker& worker, Labels& labels) const;
  bool round(int number, bool unary_only, const StopCondition& stop, Labels& labels);
  bool visitLayer(int layer, int round, bool unary_only, const StopCondition& stop, Labels& labels);
  void visitCell(int layer, const Cell& cell, int round, bool unary_only, Worker& worker, Labels& labels) const;
  Candidates propose(int layer, const Cell& cell, int round, Worker& worker, const Labels& labels) const;

  const View& view_;
  const LocalExpansionParams& params_;
  FilterGuide guide_;
  PlaneCost cost_;
  Smoothness smoothness_;
  SeedPlanes seeds_;
  std::vector<Layer> layers_;
  std::vector<PlaneProposals> proposals_;  // per layer
  std::vector<Worker> workers_;            // per thread
};

}  // namespace fdp_stereo::local_expansion
