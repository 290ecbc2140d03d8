// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/speckle_filter.hpp"

namespace fdp_stereo {

/// What the views show where a map says that they show the same.
struct SeenViews {
  cv::Mat left, right;  ///< CV_8UC1
  cv::Mat vouched;      ///< CV_8UC1, not 0 where another sensor has seen something; may be empty
};

/// filterSpeckles(), and removes the regions in which the views have nothing in common: the noise of a sensor, before a
/// white wall or under a lens cap, is matched somewhere like everything else, but it is another one in each view. Kept
/// are regions whose two pictures, without what is flat or a slope along the row, are correlated by more than chance,
/// which chooses the best of many disparities.
void filterRegions(const SeenViews& views, const SpeckleFilterParams& params, cv::Mat& disparity);

}  // namespace fdp_stereo
