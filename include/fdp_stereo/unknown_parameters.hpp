// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {

/// All names that are in no list, each with its advice, and where to read on if some are stereo_image_proc's; "" for
/// none.
std::string describeUnknown(const std::vector<ParamRef>& refs, const std::vector<std::string>& names);

}  // namespace fdp_stereo
