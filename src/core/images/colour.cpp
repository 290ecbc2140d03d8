// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/colour.hpp"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace fdp_stereo {

std::array<double, kThirds> colourWeights(double gamma) {
  std::array<double, kThirds> weights{};
  for (int i = 0; i < kThirds; ++i) weights[i] = std::exp(-i / (3.0 * gamma));
  return weights;
}

const cv::Mat& eightBitGrey(const cv::Mat& image, const cv::Mat& grey, cv::Mat& buffer) {
  if (image.channels() == 1) return image;
  if (grey.type() == CV_8UC1 && !grey.empty()) return grey;
  cv::cvtColor(image, buffer, cv::COLOR_BGR2GRAY);
  return buffer;
}

}  // namespace fdp_stereo
