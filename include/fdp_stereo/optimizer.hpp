// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/disparity_propagation.hpp"
#include "fdp_stereo/matching_cost.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

enum class OptimizerType { kWinnerTakesAll, kSemiGlobal, kLocalExpansion };

/// Called from the calling thread after every step of a long run: steps done, steps in all, energy.
using OptimizerProgress = std::function<void(int, int, double)>;

/// What stage 7 works on. References must outlive the call.
struct OptimizerInput {
  const CostVolume& volume;
  const StereoPair& pair;  ///< left as given, right aligned
  const Seeds& seeds;
  const std::atomic<bool>* cancel = nullptr;          ///< set from another thread: return the best so far, soon
  const MatchingCostParams* matching_cost = nullptr;  ///< what the volume was computed with, where it was computed
  OptimizerProgress progress;                         ///< may be empty
  std::vector<SeedPrior> priors;                      ///< what was spread in the volume already, for other volumes
};

struct OptimizerOutput {
  cv::Mat disparity_left;        ///< CV_32FC1 px, NaN = none
  cv::Mat disparity_right;       ///< the same of the right view, or empty where the optimiser has none
  cv::Mat confidence;            ///< CV_32FC1 0..1
  std::vector<double> energies;  ///< per iteration, where there is an energy
};

/// Stage 7: from costs to disparities. Keeps its buffers between calls; not thread-safe.
class Optimizer {
 public:
  virtual ~Optimizer() = default;
  virtual void optimize(const OptimizerInput& input, OptimizerOutput& output) = 0;
  /// The largest penalty beside the data term that has to fit beside a cost into one path cost, in cost units (0 =
  /// none).
  virtual double costHeadroom() const { return 0.0; }
  /// Bytes that the optimiser needs beside the volume for every cost in it.
  virtual double bytesPerCost() const { return 2.0; }
  /// Forget what was learnt from earlier frames.
  virtual void reset() {}
};

}  // namespace fdp_stereo
