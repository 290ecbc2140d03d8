// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Stage 7, from costs to disparities.
enum class OptimizerType { kWinnerTakesAll, kSemiGlobal, kLocalExpansion };

/// Called from the calling thread after every step of a long run: steps done, steps in all, energy.
using OptimizerProgress = std::function<void(int, int, double)>;

struct OptimizerOutput {
  cv::Mat disparity_left;        ///< CV_32FC1 px, NaN = none
  cv::Mat disparity_right;       ///< the same of the right view, or empty where the optimiser has none
  cv::Mat margin;                ///< CV_32FC1 cost units, of the left view: how much worse the best other answer is
  std::vector<double> energies;  ///< per iteration, where there is an energy
};

}  // namespace fdp_stereo
