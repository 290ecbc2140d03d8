// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/peer.hpp"

#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

constexpr double kSubpixelSteps = 16.0;  // OpenCV's matchers count in 1/16 px

int roundUpTo16(int count) { return (count + 15) / 16 * 16; }

cv::Ptr<cv::StereoMatcher> makeSgbm(int disparities, bool three_way) {
  const int block = three_way ? 5 : 3;
  const int area = block * block;
  return cv::StereoSGBM::create(0, disparities, block, 24 * area, 96 * area, 1, 63, three_way ? 10 : 0,
                                three_way ? 100 : 0, three_way ? 2 : 0,
                                three_way ? cv::StereoSGBM::MODE_SGBM_3WAY : cv::StereoSGBM::MODE_HH);
}

cv::Ptr<cv::StereoMatcher> makeBm(int disparities) {
  const cv::Ptr<cv::StereoBM> matcher = cv::StereoBM::create(disparities, 15);
  matcher->setUniquenessRatio(15);
  matcher->setSpeckleWindowSize(100);
  matcher->setSpeckleRange(4);
  return matcher;
}

/// 8-bit image with `border` columns repeated on the left. StereoSGBM's penalties above are those for three channels,
/// so it is given three.
cv::Mat peerImage(const cv::Mat& image, int border, bool grey) {
  cv::Mat prepared = image;
  if (prepared.depth() == CV_16U) prepared.convertTo(prepared, CV_8U, 1.0 / 256.0);
  if (grey && prepared.channels() == 3) cv::cvtColor(prepared, prepared, cv::COLOR_BGR2GRAY);
  if (!grey && prepared.channels() == 1) cv::cvtColor(prepared, prepared, cv::COLOR_GRAY2BGR);
  cv::copyMakeBorder(prepared, prepared, 0, 0, border, 0, cv::BORDER_REPLICATE);
  return prepared;
}

}  // namespace

const char* peerName(Peer peer) {
  switch (peer) {
    case Peer::kSgbmHh:
      return "sgbm_hh";
    case Peer::kSgbm3Way:
      return "sgbm_3way";
    default:
      return "bm";
  }
}

PeerMatcher::PeerMatcher(Peer peer, const Scene& scene)
    : disparities_(roundUpTo16(scene.num_disparities)),
      left_(peerImage(scene.left, disparities_, peer == Peer::kBm)),
      right_(peerImage(scene.right, disparities_, peer == Peer::kBm)),
      matcher_(peer == Peer::kBm ? makeBm(disparities_) : makeSgbm(disparities_, peer == Peer::kSgbm3Way)) {}

void PeerMatcher::compute() { matcher_->compute(left_, right_, raw_); }

cv::Mat PeerMatcher::disparity() const {
  cv::Mat disparity;
  raw_.colRange(disparities_, raw_.cols).convertTo(disparity, CV_32F, 1.0 / kSubpixelSteps);
  disparity.setTo(kInvalidDisparity, disparity < 0.0F);
  return disparity;
}

}  // namespace fdp_stereo
