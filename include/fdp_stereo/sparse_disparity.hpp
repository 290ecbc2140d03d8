// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 5: matches (and other sensors' depth) to seeds (paper 3.2).
struct SparseDisparityParams {
  bool reject_outliers = true;  ///< consensus with neighbours; the paper trusts every match
  bool refine = true;           ///< sub-pixel refinement along the row
};

struct SparseDisparity {
  Seeds seeds;                 ///< sorted by (y, x)
  Seeds rejected;              ///< for display
};

/// Seeds of one pair (images aligned by stage 2). External seeds outside the range or the image are dropped.
SparseDisparity buildSparseDisparity(const FeatureMatches& matches, const Seeds& external, const StereoPair& pair,
                                     DisparityRange range, const SparseDisparityParams& params);

}  // namespace fdp_stereo
