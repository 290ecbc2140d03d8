// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Where a patch of the left view lies in the right one, to a fraction of a pixel.
struct PatchFit {
  bool converged = false;
  cv::Point2f right;         ///< px
  float correlation = 0.0F;  ///< normalised, -1..1, of the patches at the end
};

/// Least-squares fit of the 11 x 11 patch around left pixel `left` to the right view, starting at `start` (inverse
/// compositional Lucas-Kanade, Baker and Matthews, IJCV 2004, for a translation; gain and offset of the grey values
/// are free). Images: CV_8UC1. Not converged where the patch leaves an image, has no texture in one direction, or
/// moves by more than 2 px.
PatchFit fitPatch(const cv::Mat& left_grey, const cv::Mat& right_grey, cv::Point left, cv::Point2f start);

}  // namespace fdp_stereo
