// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

struct FeatureMatchingParams;

/// A pair of corners that are each other's best, before refinement.
struct CornerMatch {
  cv::Point left;
  cv::Point right;
  float ratio = 0.0F;  ///< distance of the best over that of the second best, 0..1
};

/// FAST corners (Rosten and Drummond, ECCV 2006), at most params.max_features per view and spread over the image, with
/// a 256-bit code of brightness comparisons (Calonder et al., BRIEF, ECCV 2010; upright, one scale), each compared with
/// the corners of the other view inside the disparity range and the row band. Ratio and mutual test as params say.
/// Images: CV_8UC1.
std::vector<CornerMatch> matchCorners(const cv::Mat& left_grey, const cv::Mat& right_grey, DisparityRange range,
                                      const FeatureMatchingParams& params);

}  // namespace fdp_stereo
