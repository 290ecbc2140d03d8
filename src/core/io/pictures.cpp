// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "arguments.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
cv::Mat noneMask(const cv::Mat& map) {
  // Not map != map: OpenCV compares four values at once with an instruction for which NaN differs from nothing.
  return ~(map == map);
}

cv::Mat colorize(const cv::Mat& disparity, DisparityRange range) {
  requireMap(disparity, "picture of a disparity");
  cv::Mat grey(disparity.size(), CV_8UC1);
  const float span = static_cast<float>(std::max(1, range.count - 1));
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const float d = disparity.at<float>(y, x);
      const float level = std::isnan(d) ? 0.0F : 255.0F * (d - static_cast<float>(range.min)) / span;
      grey.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(level);
    }
  }
  cv::Mat colors;
  cv::applyColorMap(grey, colors, cv::COLORMAP_TURBO);
  colors.setTo(cv::Scalar::all(0), noneMask(disparity));
  return colors;
}

cv::Mat confidenceToGrey(const cv::Mat& confidence) {
  requireMap(confidence, "picture of a confidence");
  cv::Mat grey;
  confidence.convertTo(grey, CV_8U, 255.0);
  grey.setTo(0, noneMask(confidence));
  return grey;
}

}  // namespace fdp_stereo
