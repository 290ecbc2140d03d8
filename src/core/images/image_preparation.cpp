// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/image_preparation.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

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

/// How often each 16-bit value occurs.
using Histogram = std::vector<int>;

void count(const cv::Mat& image, Histogram& histogram) {
  for (int y = 0; y < image.rows; ++y) {
    const auto* values = image.ptr<std::uint16_t>(y);
    for (int i = 0; i < image.cols * image.channels(); ++i) ++histogram[values[i]];
  }
}

/// The smallest value that more than `below` pixels do not exceed.
int quantile(const Histogram& histogram, std::int64_t below) {
  int value = 0;
  for (std::int64_t sum = 0; value < static_cast<int>(histogram.size()) - 1; ++value) {
    sum += histogram[value];
    if (sum > below) break;
  }
  return value;
}

/// What all but the darkest and the brightest few need.
ValueRange measureRange(Histogram histogram) {
  constexpr std::int64_t kOutliers = 200;  // 1 of so many pixels at each end
  histogram[0] = 0;                        // what rectification does not see
  const std::int64_t total = std::accumulate(histogram.begin(), histogram.end(), std::int64_t{0});
  if (total == 0) return {0, 255};
  const int black = quantile(histogram, total / kOutliers);
  const int white = quantile(histogram, total - 1 - total / kOutliers);
  return {black, std::max(white, black + 255)};
}

/// Whether a pair that asks for `wanted` can stay with `kept`.
bool fits(ValueRange kept, ValueRange wanted) {
  constexpr int kTolerance = 8;  // 1 of so many parts
  const int largest = (kept.white - kept.black) / kTolerance;
  return std::abs(wanted.black - kept.black) <= largest && std::abs(wanted.white - kept.white) <= largest;
}

cv::Mat toEightBit(const cv::Mat& image, ValueRange range) {
  const int width = range.white - range.black;
  std::vector<std::uint8_t> table(65536);
  for (int value = 0; value < 65536; ++value) {
    table[value] = static_cast<std::uint8_t>((std::clamp(value - range.black, 0, width) * 255 + width / 2) / width);
  }
  cv::Mat result(image.size(), CV_MAKETYPE(CV_8U, image.channels()));
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint16_t>(y);
    auto* to = result.ptr<std::uint8_t>(y);
    for (int i = 0; i < image.cols * image.channels(); ++i) to[i] = table[from[i]];
  }
  return result;
}

}  // namespace

StereoPair prepareImages(const cv::Mat& left, const cv::Mat& right, ValueRange& range) {
  check(left, right);
  StereoPair pair;
  pair.left_grey = toGrey(left);
  pair.right_grey = toGrey(right);
  const bool colour = left.channels() == 3 && right.channels() == 3;
  pair.left = colour ? left : pair.left_grey;
  pair.right = colour ? right : pair.right_grey;
  if (left.depth() == CV_8U) return pair;
  Histogram histogram(65536);
  count(pair.left, histogram);
  count(pair.right, histogram);
  const ValueRange wanted = measureRange(std::move(histogram));
  if (!fits(range, wanted)) range = wanted;
  pair.left = toEightBit(pair.left, range);
  pair.right = toEightBit(pair.right, range);
  return pair;
}

StereoPair prepareImages(const cv::Mat& left, const cv::Mat& right) {
  ValueRange range;
  return prepareImages(left, right, range);
}

cv::Mat toEightBit(const cv::Mat& image) { return prepareImages(image, image).left; }

}  // namespace fdp_stereo
