// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fdp_stereo {

struct Preset {
  std::string name;
  std::string yaml;
};

/// config/*.yaml as built in.
const std::vector<Preset>& builtInPresets();

}  // namespace fdp_stereo
