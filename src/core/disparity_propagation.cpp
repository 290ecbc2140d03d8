// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/disparity_propagation.hpp"

namespace fdp_stereo {
double propagateDisparity(const Seeds&, const cv::Mat&, const DisparityPropagationParams&, CostVolume&) { return 0.0; }
}  // namespace fdp_stereo
