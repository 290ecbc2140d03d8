// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/sparse_disparity.hpp"

namespace fdp_stereo {
SparseDisparity buildSparseDisparity(const FeatureMatches&, const Seeds&, const StereoPair&, DisparityRange,
                                     const SparseDisparityParams&) {
  return {};
}
}  // namespace fdp_stereo
