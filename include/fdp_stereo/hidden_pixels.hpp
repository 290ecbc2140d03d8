// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Takes away the disparities (CV_32FC1 px) that point beside the right image, where no camera can have seen the match.
void dropHidden(cv::Mat& disparity);

}  // namespace fdp_stereo
