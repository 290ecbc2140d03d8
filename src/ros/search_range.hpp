// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "camera.hpp"
#include "fdp_stereo/types.hpp"

/// What a range of disparities means for one camera.
namespace fdp_stereo {

/// Throws std::invalid_argument where no pixel can have a disparity of the range, which is a mistake and not an empty
/// scene; appends to `warnings` where the range is odd.
void checkRange(DisparityRange range, int width, const StereoGeometry& geometry, std::vector<std::string>& warnings);

/// The distances that a checked range can see, and what to change to see more.
std::string visibleDistances(DisparityRange range, int width, const StereoGeometry& geometry);

}  // namespace fdp_stereo
