// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/image_preparation.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

std::string describe(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + ", " + std::to_string(image.channels()) +
         " channel(s), OpenCV depth " + std::to_string(image.depth());
}

void check(const cv::Mat& left, const cv::Mat& right) {
  for (const cv::Mat& image : {left, right}) {
    const bool depth = image.depth() == CV_8U || image.depth() == CV_16U;
    const bool channels = image.channels() == 1 || image.channels() == 3;
    if (image.empty() || image.dims != 2 || !depth || !channels) {
      throw std::invalid_argument("image (" + describe(image) +
                                  ") cannot be matched: it must be of 8 or 16 bits with 1 or 3 channels and not empty");
    }
  }
  if (left.size() != right.size() || left.depth() != right.depth()) {
    throw std::invalid_argument("left image (" + describe(left) + ") and right image (" + describe(right) +
                                ") differ in size or depth");
  }
}

cv::Mat toGrey(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

/// Bits by which the largest value of both images exceeds 8 bits.
int excessBits(const cv::Mat& left, const cv::Mat& right) {
  double largest = 0.0;
  for (const cv::Mat& image : {left, right}) {
    double value = 0.0;
    cv::minMaxLoc(image.reshape(1), nullptr, &value);
    largest = std::max(largest, value);
  }
  int shift = 0;
  while (static_cast<int>(largest) >> shift > 255) ++shift;
  return shift;
}

cv::Mat toEightBit(const cv::Mat& image, int shift) {
  if (image.depth() == CV_8U) return image;
  cv::Mat result(image.size(), CV_MAKETYPE(CV_8U, image.channels()));
  const int count = image.cols * image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint16_t>(y);
    auto* to = result.ptr<std::uint8_t>(y);
    for (int i = 0; i < count; ++i) to[i] = static_cast<std::uint8_t>(from[i] >> shift);
  }
  return result;
}

}  // namespace

StereoPair prepareImages(const cv::Mat& left, const cv::Mat& right) {
  check(left, right);
  StereoPair pair;
  pair.left_grey = toGrey(left);
  pair.right_grey = toGrey(right);
  const bool colour = left.channels() == 3 && right.channels() == 3;
  pair.left = colour ? left : pair.left_grey;
  pair.right = colour ? right : pair.right_grey;
  if (left.depth() == CV_16U) {
    const int shift = excessBits(pair.left, pair.right);
    pair.left = toEightBit(pair.left, shift);
    pair.right = toEightBit(pair.right, shift);
  }
  return pair;
}

}  // namespace fdp_stereo
