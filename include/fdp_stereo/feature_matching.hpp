// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

enum class FeatureDetector { kSift, kOrb, kFastCensus };

/// Stage 1: features of both views and their matches (paper 3.2, eq. 1 and 10).
struct FeatureMatchingParams {
  FeatureDetector detector = FeatureDetector::kSift;
  double max_ratio = 0.6;                ///< MD0 / MD1 of eq. (10); a match above is dropped
  double max_row_difference_px = 1.0;    ///< |v_p - v_q|; a rectified pair has its matches on the row
  bool mutual_check = true;              ///< p must also be the best match of q
  int max_features = 4000;               ///< per view, strongest first
};

/// Matches inside the disparity range that pass ratio, row and mutual checks, sorted by (y, x) of the left position.
/// Images: 8-bit, 1 or 3 channels, one size. Few or no features give few or no matches, never an error.
FeatureMatches matchFeatures(const StereoPair& pair, DisparityRange range, const FeatureMatchingParams& params);

}  // namespace fdp_stereo
