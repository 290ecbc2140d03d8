// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/left_right_check.hpp"

#include <cmath>

namespace fdp_stereo {

void checkLeftRight(cv::Mat& disparity_left, const cv::Mat& disparity_right, const LeftRightCheckParams& params) {
  const auto max_difference = static_cast<float>(params.max_difference_px);
#pragma omp parallel for schedule(static)
  for (int y = 0; y < disparity_left.rows; ++y) {
    auto* left = disparity_left.ptr<float>(y);
    const auto* right = disparity_right.ptr<float>(y);
    for (int x = 0; x < disparity_left.cols; ++x) {
      if (std::isnan(left[x])) continue;
      const auto match = static_cast<int>(std::lround(static_cast<float>(x) - left[x]));
      const bool inside = match >= 0 && match < disparity_left.cols;
      if (!inside || !(std::abs(left[x] - right[match]) <= max_difference)) left[x] = kInvalidDisparity;
    }
  }
}

}  // namespace fdp_stereo
