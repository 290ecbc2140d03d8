// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace fdp_stereo::local_expansion {

/// What a guided filter (He et al., PAMI 2013) needs to know of its guide, once per view.
///
/// With the sums s = (sum p, sum p r, sum p g, sum p b) of a window, the offset and slopes of the local linear model
/// are M s, where M inverts [N, sum I; sum I', sum I I' + N eps]: means, covariance and pixel count in one matrix.
struct FilterGuide {
  int radius = 0;
  cv::Size size;
  std::vector<float> channels;  ///< [y][x][4]: 1 and the three colours in -0.5..0.5 (grey: the last two are 0)
  std::vector<float> inverse;   ///< [y][x][10]: M, upper triangle by rows
};

/// image: CV_8UC1 or CV_8UC3. epsilon > 0: regularisation for colours scaled to 0..1. Windows are clipped to the image.
FilterGuide makeFilterGuide(const cv::Mat& image, int radius, double epsilon);

}  // namespace fdp_stereo::local_expansion
