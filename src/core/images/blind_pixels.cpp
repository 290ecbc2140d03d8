// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/blind_pixels.hpp"

#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

/// 255 in every window of side x side px whose values differ by at most `difference`.
cv::Mat flatWindows(const cv::Mat& grey, int side, double difference) {
  const cv::Mat window(side, side, CV_8UC1, cv::Scalar(1));
  cv::Mat largest, smallest, flat;
  cv::dilate(grey, largest, window);
  cv::erode(grey, smallest, window);
  cv::dilate(largest - smallest <= difference, flat, window);
  return flat;
}

}  // namespace

cv::Mat blindPixels(const cv::Mat& grey) { return flatWindows(grey, 5, 0.0) | flatWindows(grey, 15, 1.0); }

}  // namespace fdp_stereo
