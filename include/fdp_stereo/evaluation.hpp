// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

constexpr std::array<double, 5> kBadThresholdsPx = {0.125, 0.25, 0.5, 1.0, 2.0};

/// Errors over the scored pixels that have a truth; a pixel without answer counts as bad. Shares in %.
struct DisparityErrors {
  std::array<double, 5> bad{};
  double density = 0.0;
  double sparse_bad_half = 100.0;  ///< bad 0.5 among the answered
  double average_px = 100.0;       ///< mean error of the answered, each capped at 100 px
};

/// mask: CV_8UC1, 255 = scored, or empty = all. Throws std::invalid_argument when the sizes differ.
DisparityErrors evaluateDisparity(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask);

}  // namespace fdp_stereo
