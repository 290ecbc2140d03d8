// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// How far each disparity can be believed, by a model that was fitted to scenes with truth (docs/confidence.md).
struct DisparityQuality {
  cv::Mat confidence;  ///< CV_32FC1, 0..1: probability that the disparity is off by at most 1 px; 0 where there is none
  cv::Mat sigma;       ///< CV_32FC1 px: standard deviation of the disparity; NaN where there is none
  std::vector<cv::Mat> measures;  ///< CV_32FC1, what the model looks at, where that is asked for
};

/// What the stages before found, in the left view.
struct QualityInput {
  const cv::Mat& roughness;        ///< disparityRoughness() of the optimiser's answer
  const cv::Mat& margin;           ///< of the optimiser
  const cv::Mat& disparity;        ///< after the checks, not filled: NaN = none
  const cv::Mat& disparity_right;  ///< or empty
  const cv::Mat& guide;            ///< left image, CV_8UC1
  DisparityRange search;
};

/// Steps from the left and the upper neighbour, each at most 2 px, in 1/63 px; CV_8UC1. Disparities of an optimiser,
/// before any check: where it was wrong they scatter.
cv::Mat disparityRoughness(const cv::Mat& disparity);

/// Stage 8e: confidence and sigma of every disparity.
DisparityQuality judgeDisparity(const QualityInput& input, bool keep_measures = false);

}  // namespace fdp_stereo
