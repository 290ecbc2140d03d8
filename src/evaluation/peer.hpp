// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/calib3d.hpp>

#include "evaluation/scene.hpp"

namespace fdp_stereo {

enum class Peer { kSgbmHh, kSgbm3Way, kBm };

/// "sgbm_hh", "sgbm_3way" or "bm".
const char* peerName(Peer peer);

/// One of OpenCV's matchers with the images of one scene made ready for it, so that compute() can be timed alone.
///
/// StereoSGBM: MODE_HH block 3, or MODE_SGBM_3WAY block 5, uniqueness 10, speckles 100/2; StereoBM: block 15,
/// uniqueness 15, speckles 100/4. The number of disparities is rounded up to 16, and as many columns are repeated on
/// the left of the images, so that the matcher answers there too.
class PeerMatcher {
 public:
  PeerMatcher(Peer peer, const Scene& scene);
  void compute();
  /// What compute() found: CV_32FC1 px, NaN = none.
  cv::Mat disparity() const;

 private:
  int disparities_;
  cv::Mat left_, right_, raw_;
  cv::Ptr<cv::StereoMatcher> matcher_;
};

}  // namespace fdp_stereo
