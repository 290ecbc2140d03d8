// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/view_masks.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

bool isMasked(const cv::Mat& mask, float x, float y) {
  const cv::Point pixel(cvRound(x), cvRound(y));
  return !mask.empty() && cv::Rect({0, 0}, mask.size()).contains(pixel) && mask.at<std::uint8_t>(pixel) != 0;
}

cv::Mat shrinkMask(const cv::Mat& mask, cv::Size size) {
  if (mask.empty() || mask.size() == size) return mask;
  cv::Mat share;
  cv::Mat(mask != 0).convertTo(share, CV_32F);
  cv::resize(share, share, size, 0.0, 0.0, cv::INTER_AREA);
  return share > 0.0F;
}

}  // namespace

void checkMask(const cv::Mat& mask, cv::Size size, const std::string& name) {
  if (mask.empty() || (mask.type() == CV_8UC1 && mask.size() == size)) return;
  throw std::invalid_argument(name + " of " + std::to_string(mask.cols) + " x " + std::to_string(mask.rows) + " px, " +
                              std::to_string(mask.channels()) + " channels: must be grey, of 8 bits and of the " +
                              std::to_string(size.width) + " x " + std::to_string(size.height) + " px of the image");
}

ViewMasks shrinkMasks(const ViewMasks& masks, cv::Size size) {
  return {shrinkMask(masks.left, size), shrinkMask(masks.right, size)};
}

void dropMasked(const ViewMasks& masks, Seeds& seeds) {
  const auto masked = [&](const Seed& seed) {
    return isMasked(masks.left, seed.x, seed.y) || isMasked(masks.right, seed.x - seed.d, seed.y);
  };
  seeds.erase(std::remove_if(seeds.begin(), seeds.end(), masked), seeds.end());
}

void dropMasked(const ViewMasks& masks, FeatureMatches& matches) {
  const auto masked = [&](const FeatureMatch& match) {
    return isMasked(masks.left, match.left.x, match.left.y) || isMasked(masks.right, match.right.x, match.right.y);
  };
  matches.erase(std::remove_if(matches.begin(), matches.end(), masked), matches.end());
}

void dropMasked(const ViewMasks& masks, cv::Mat& disparity) {
  if (!masks.left.empty()) disparity.setTo(kInvalidDisparity, masks.left);
  if (masks.right.empty()) return;
  for (int y = 0; y < disparity.rows; ++y) {
    auto* d = disparity.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      if (!std::isnan(d[x]) && isMasked(masks.right, static_cast<float>(x) - d[x], static_cast<float>(y))) {
        d[x] = kInvalidDisparity;
      }
    }
  }
}

}  // namespace fdp_stereo
