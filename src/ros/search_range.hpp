// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "camera.hpp"
#include "fdp_stereo/types.hpp"

/// What a range of disparities means for one camera.
namespace fdp_stereo {

/// Between the median sigmas of sure pixels, preset fast: 0.19 to 0.35 px by data set (docs/confidence.md).
constexpr double kTypicalSigmaPx = 0.25;

/// Throws std::invalid_argument where no pixel can have a disparity of the range, which is a mistake and not an empty
/// scene; appends to `warnings` where the range is odd.
void checkRange(DisparityRange range, int width, const StereoGeometry& geometry, std::vector<std::string>& warnings);

/// The distances that a checked range can see, and what to change to see more.
std::string visibleDistances(DisparityRange range, int width, const StereoGeometry& geometry);

/// The standard deviation of the depth at 1, 2, 5 and 10 m that an error of `sigma_px` of the disparity means.
std::string depthErrors(double sigma_px, const StereoGeometry& geometry);

/// The disparity_range with which things from `nearest_m` on are seen; a multiple of 16, which costs the same.
/// Throws std::invalid_argument where there is none.
int disparityRangeFor(double nearest_m, int min_disparity, const StereoGeometry& geometry);

}  // namespace fdp_stereo
