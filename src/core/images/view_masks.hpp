// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// The pixels that a user leaves out of each view: CV_8UC1, not 0 = left out; empty = none.
struct ViewMasks {
  cv::Mat left;
  cv::Mat right;
  bool empty() const { return left.empty() && right.empty(); }
};

/// Throws std::invalid_argument where a mask is not CV_8UC1 or not of this size.
void checkMask(const cv::Mat& mask, cv::Size size, const std::string& name);

/// Masks of smaller views: what holds any masked pixel is masked.
ViewMasks shrinkMasks(const ViewMasks& masks, cv::Size size);

/// Removes seeds under the left mask, and those that lead under the right one.
void dropMasked(const ViewMasks& masks, Seeds& seeds);

/// Removes matches under either mask.
void dropMasked(const ViewMasks& masks, FeatureMatches& matches);

/// Removes the disparities (CV_32FC1) of masked pixels, and those that lead to masked pixels of the right view.
void dropMasked(const ViewMasks& masks, cv::Mat& disparity);

}  // namespace fdp_stereo
