// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// What the fine structure of an image (the Laplacian) says beside its coarse one (differences over 4 px).
struct ImageQuality {
  double noise = 0.0;  ///< fine structure of the plainest places, in parts of the median coarse structure
  double fine = 1.0;   ///< fine in parts of coarse, the median over the image: little after compression and blur
  double edges = 1.0;  ///< the same at the strongest tenth: blur alone takes this, too
  double grain = 0.0;  ///< fine structure of the plainest places, grey levels: about the noise of independent pixels
};

/// From every 8th row of a CV_8UC1 image; of one that is too small or shows nothing: the defaults.
ImageQuality measureQuality(const cv::Mat& grey);

}  // namespace fdp_stereo
