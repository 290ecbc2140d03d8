// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// A disparity that is not known. Disparity maps are CV_32FC1 in px of the left image; NaN = none.
constexpr float kInvalidDisparity = std::numeric_limits<float>::quiet_NaN();

/// Searched disparities: min .. min + count - 1 (px). Disparity d matches left (x, y) with right (x - d, y) (paper eq.
/// 1).
struct DisparityRange {
  int min = 0;
  int count = 64;
  int max() const { return min + count - 1; }
  bool contains(float d) const { return d >= static_cast<float>(min) && d <= static_cast<float>(max()); }
};

/// A rectified pair of one size as the stages work on it (made by prepareImages()).
struct StereoPair {
  cv::Mat left;        ///< CV_8UC1 or CV_8UC3 (BGR)
  cv::Mat right;       ///< the same type and size
  cv::Mat left_grey;   ///< CV_8UC1 or CV_16UC1, the full depth of the input
  cv::Mat right_grey;  ///< the same type and size
};

/// One feature matched between the views; positions in px, pixel centres at integers.
struct FeatureMatch {
  cv::Point2f left;
  cv::Point2f right;
  /// 0..1: how far the match can be believed.
  float trust = 1.0F;
  /// d = u_p - u_q (paper eq. 1).
  float disparity() const { return left.x - right.x; }
  /// v_p - v_q, px: 0 in a perfectly rectified pair.
  float rowResidual() const { return left.y - right.y; }
};
using FeatureMatches = std::vector<FeatureMatch>;

/// Where a seed came from: matched features, another sensor, a file, or a first matching of the pair (quasi_dense.hpp).
enum class SeedSource { kFeature, kPoints, kDepth, kDisparity, kFile, kQuasiDense };

/// A sparse disparity: the scene at left pixel (x, y) has disparity d (all px, real-valued).
struct Seed {
  float x = 0.0F;
  float y = 0.0F;
  float d = 0.0F;
  float trust = 1.0F;  ///< 0..1, share of such seeds that are right
  SeedSource source = SeedSource::kFeature;
};
using Seeds = std::vector<Seed>;

/// Wall time of one stage of one run.
struct StageTime {
  std::string stage;
  double ms = 0.0;
};

}  // namespace fdp_stereo
