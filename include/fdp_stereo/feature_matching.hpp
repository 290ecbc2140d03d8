// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// kSift: the paper's. kOrb: binary, rotation invariant. kFastCensus: upright FAST corners with a binary patch code,
/// compared only inside the row band and the disparity range; a tenth of the cost of SIFT.
enum class FeatureDetector { kSift, kOrb, kFastCensus };

/// Stage 1: features of both views and their matches (paper 3.2, eq. 1 and 10).
struct FeatureMatchingParams {
  FeatureDetector detector = FeatureDetector::kFastCensus;
  double max_ratio = 0.8;              ///< MD0 / MD1 of eq. (10); a match above is dropped
  double max_row_difference_px = 4.0;  ///< |v_p - v_q|; a rectified pair has its matches on the row
  bool mutual_check = true;            ///< p must also be the best match of q
  double max_scale_ratio = 1.5;  ///< of the feature sizes of both views, >= 1; 0 = no check (kFastCensus has one size)
  bool refine = true;            ///< both coordinates by least squares on the grey patches (Lucas-Kanade)
  int max_features = 1500;       ///< per view, strongest first
};

struct FeatureMatching {
  FeatureMatches matches;                             ///< sorted by (y, x) of the left position
  FeatureDetector detector = FeatureDetector::kSift;  ///< the one that ran
  std::string note;                                   ///< why another detector than the wanted one ran; empty otherwise
};

/// Matches inside the disparity range that pass ratio, row, scale and mutual checks.
/// Images: 8-bit, 1 or 3 (BGR) channels, one size; std::invalid_argument otherwise. Few or no features give few or no
/// matches, never an error. Where OpenCV was built without SIFT, ORB takes its place and the note says so.
FeatureMatching matchFeatures(const StereoPair& pair, DisparityRange range, const FeatureMatchingParams& params);

}  // namespace fdp_stereo
