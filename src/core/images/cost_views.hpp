// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/matching_cost.hpp"
#include "fdp_stereo/types.hpp"
#include "images/image_quality.hpp"

namespace fdp_stereo {

/// Gaussian blur for the matching cost, px, and what noise asks of the gradient term.
struct CostSmoothing {
  double left_px = 0.0, right_px = 0.0;  ///< of the sharper view, until both are alike
  double census_px = 0.0;                ///< of both, beyond that, for the census
  double gradient_px = 0.0;              ///< and for the gradient
  double lambda_factor = 1.0;            ///< of lambda_rho: noise must not look like a difference
};

/// What the qualities of the views ask for; nothing for good images. Changes steadily with them.
CostSmoothing smoothingFor(const ImageQuality& left, const ImageQuality& right);

/// What the matching cost is computed from.
struct CostViews {
  StereoPair pair;  ///< left and right for colours and gradients, the grey ones for the census
  MatchingCostParams params;
};

/// The views smoothed as far as noise, compression or a view out of focus ask for it, where params.adapt is set.
CostViews costViews(const StereoPair& pair, const MatchingCostParams& params);

}  // namespace fdp_stereo
