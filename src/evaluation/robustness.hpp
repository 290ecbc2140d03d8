// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/result.hpp"

namespace fdp_stereo {

/// How much of StereoSGBM's bad 1 the other methods have, on each kind of images.
struct Robustness {
  struct Kind {
    std::string corruption;
    std::vector<double> ratios;  ///< of each method's mean to that of sgbm_hh over as many scenes; or unknown
  };
  std::vector<std::string> methods;
  std::vector<Kind> kinds;
};

/// Empty where no row is of corrupted images or none of sgbm_hh.
Robustness robustnessOf(const std::vector<ResultRow>& rows);

/// An aligned text table; "" for nothing.
std::string tableText(const Robustness& robustness);

}  // namespace fdp_stereo
