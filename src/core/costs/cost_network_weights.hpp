// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace fdp_stereo {

/// The weights as trained; training/README.md tells their order and scales.
struct NetworkWeights {
  std::array<int, 3> channels;  ///< of each layer's output
  int floor;                    ///< least length of a descriptor before it is normalised, in 1/65536
  std::vector<std::int32_t> numbers;
};

/// Those built into the library, from training/cost_network.txt.
const NetworkWeights& costNetworkWeights();

}  // namespace fdp_stereo
