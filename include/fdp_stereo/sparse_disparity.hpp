// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 5: matches (and other sensors' depth) to seeds (paper 3.2).
struct SparseDisparityParams {
  bool features = false;             ///< spread feature matches; else they vouch for other seeds
  bool reject_outliers = true;       ///< row residual and neighbourhood; the paper trusts every match
  double max_row_residual_px = 0.3;  ///< of a match after row alignment
  double max_deviation_px = 0.67;    ///< mean deviation (0..2) of small windows around a match from its disparity
  double min_support = 0.2;          ///< share (0..1) of the neighbours, by weight, that a seed must agree with
  double tolerance_px = 1.0;         ///< two seeds agree if their disparities differ by at most this much ...
  double max_slope = 0.15;           ///< ... and this much (px / px) times their distance
};

struct SparseDisparity {
  Seeds seeds;     ///< sorted by (y, x)
  Seeds rejected;  ///< for display, sorted by (y, x)
};

/// Seeds of one pair (images aligned by stage 2). External seeds outside the range or the image are dropped.
///
/// A match off its row is rejected, and so is a seed of any source that too few of its (up to 12) neighbours agree
/// with, weighted by nearness and likeness of colour; the trust of what stays is scaled by the share that agrees. pair:
/// 8-bit images of one size.
SparseDisparity buildSparseDisparity(const FeatureMatches& matches, const Seeds& external, const StereoPair& pair,
                                     DisparityRange range, const SparseDisparityParams& params);

/// The seeds as discs on the dimmed left image, coloured by disparity over the range, quasi-dense ones as dots,
/// rejected ones as crosses. CV_8UC3. left: 8-bit, 1 or 3 channels.
cv::Mat drawSeeds(const cv::Mat& left, const SparseDisparity& sparse, DisparityRange range);

}  // namespace fdp_stereo
