// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 8b: removes connected regions (4-neighbours, steps up to max_difference_px) smaller than max_size px.
struct SpeckleFilterParams {
  int max_size = 60;  ///< px; 0 = off
  double max_difference_px = 1.0;
};

void filterSpeckles(cv::Mat& disparity, const SpeckleFilterParams& params);

}  // namespace fdp_stereo
