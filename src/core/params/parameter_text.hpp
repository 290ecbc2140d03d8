// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {

/// The shortest text that reads back as the same number.
std::string formatNumber(double value);
/// "a, b, c".
std::string join(const std::vector<std::string>& words);
bool inRange(const ParamRef& ref, double value);
/// Throws std::invalid_argument naming key, value and what is allowed.
[[noreturn]] void reject(const ParamRef& ref, const std::string& value);
/// findParam() that throws std::invalid_argument with the nearest name.
const ParamRef& requireParam(const std::vector<ParamRef>& refs, const std::string& name);

}  // namespace fdp_stereo
