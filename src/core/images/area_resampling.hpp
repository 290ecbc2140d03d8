// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Every pixel of a smaller image is the mean of the area that it covers. CV_8U or CV_16U, any number of channels. As
/// cv::resize() with INTER_AREA, but exact before it is rounded: the same bits on every processor.
cv::Mat shrinkByArea(const cv::Mat& image, cv::Size size);

}  // namespace fdp_stereo
