// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/subpixel.hpp"

namespace fdp_stereo {

struct WinnerTakesAllParams {
  SubpixelFit subpixel = SubpixelFit::kParabola;
  double uniqueness_ratio =
      0.0;  ///< %: the best cost must be this much below the best of a disparity more than 1 px off
};

/// The disparity of the smallest cost, the lowest on ties, for the left view and (from the same volume) the right.
class WinnerTakesAll : public Optimizer {
 public:
  explicit WinnerTakesAll(const WinnerTakesAllParams& params) : params_(params) {}
  void optimize(const OptimizerInput& input, OptimizerOutput& output) override;

 private:
  WinnerTakesAllParams params_;
};

}  // namespace fdp_stereo
