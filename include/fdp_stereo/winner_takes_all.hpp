// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/subpixel.hpp"

namespace fdp_stereo {

struct WinnerTakesAllParams {
  SubpixelFit subpixel = SubpixelFit::kParabola;
  /// %: the best cost must be this much below the best of a disparity more than 1 px off
  double uniqueness_ratio = 0.0;
};

/// The disparity of the smallest cost for the left view and (from the same volume) the right; none where another one
/// more than 1 px off is as good.
void takeWinners(const CostVolume& volume, const WinnerTakesAllParams& params, OptimizerOutput& output);

}  // namespace fdp_stereo
