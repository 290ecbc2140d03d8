// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/speckle_filter.hpp"

#include "arguments.hpp"
#include "refinement/regions.hpp"

namespace fdp_stereo {

void filterSpeckles(cv::Mat& disparity, const SpeckleFilterParams& params) {
  requireMap(disparity, "speckle filter");
  if (params.max_size <= 0) return;
  const Regions regions(disparity, static_cast<float>(params.max_difference_px));
  regions.drop(disparity, [&](int region) { return regions.size(region) < params.max_size; });
}

}  // namespace fdp_stereo
