// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "fdp_stereo/optimizer.hpp"

namespace fdp_stereo {

/// LocalExp (Taniai et al., TPAMI 2018): continuous slanted planes by local expansion moves (paper 3.4, eq. 2 and 3).
struct LocalExpansionParams {
  double lambda = 0.5;   ///< weight of the smoothness term
};

}  // namespace fdp_stereo
