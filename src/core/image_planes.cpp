// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace fdp_stereo {

const cv::Mat& eightBitGrey(const cv::Mat& image, const cv::Mat& grey, cv::Mat& buffer) {
  if (image.channels() == 1) return image;
  if (grey.type() == CV_8UC1 && !grey.empty()) return grey;
  cv::cvtColor(image, buffer, cv::COLOR_BGR2GRAY);
  return buffer;
}

void ImagePlanes::resize(int planes, const cv::Mat& image) {
  count_ = planes;
  width_ = image.cols;
  height_ = image.rows;
  data_.resize(static_cast<std::size_t>(planes) * image.total());
}

void ImagePlanes::fillColour(const cv::Mat& image, double share) {
  const int channels = image.channels();
  std::array<std::int16_t, 256> table{};
  for (int i = 0; i < 256; ++i) {
    table[i] = static_cast<std::int16_t>(std::lround(i * share / channels * kUnitsPerGreyLevel));
  }
#pragma omp parallel for schedule(static)
  for (int y = 0; y < height_; ++y) {
    const auto* pixels = image.ptr<std::uint8_t>(y);
    for (int c = 0; c < channels; ++c) {
      std::int16_t* to = row(c, y);
      for (int x = 0; x < width_; ++x) to[x] = table[pixels[x * channels + c]];
    }
  }
}

void ImagePlanes::fillGradient(const cv::Mat& grey, double share, int first_plane) {
  const auto factor = static_cast<float>(share / 4.0 * kUnitsPerGreyLevel);
#pragma omp parallel for schedule(static)
  for (int y = 0; y < height_; ++y) {
    const auto* above = grey.ptr<std::uint8_t>(std::max(y - 1, 0));
    const auto* here = grey.ptr<std::uint8_t>(y);
    const auto* below = grey.ptr<std::uint8_t>(std::min(y + 1, height_ - 1));
    std::int16_t* horizontal = row(first_plane, y);
    std::int16_t* vertical = row(first_plane + 1, y);
    for (int x = 0; x < width_; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, width_ - 1);
      const int dx = above[right] - above[left] + 2 * (here[right] - here[left]) + below[right] - below[left];
      const int dy = below[left] - above[left] + 2 * (below[x] - above[x]) + below[right] - above[right];
      horizontal[x] = static_cast<std::int16_t>(std::lrint(static_cast<float>(dx) * factor));
      vertical[x] = static_cast<std::int16_t>(std::lrint(static_cast<float>(dy) * factor));
    }
  }
}

void ImagePlanes::makeRho(const cv::Mat& image, const cv::Mat& grey, double alpha) {
  const int colour_planes = alpha < 1.0 ? image.channels() : 0;
  resize(colour_planes + (alpha > 0.0 ? 2 : 0), image);
  if (colour_planes > 0) fillColour(image, 1.0 - alpha);
  if (alpha > 0.0) fillGradient(grey, alpha, colour_planes);
}

void ImagePlanes::makeColour(const cv::Mat& image) {
  resize(image.channels(), image);
  fillColour(image, 1.0);
}

void ImagePlanes::makeBirchfieldTomasi(const cv::Mat& grey) {
  resize(3, grey);
  fillColour(grey, 1.0);
#pragma omp parallel for schedule(static)
  for (int y = 0; y < height_; ++y) {
    const std::int16_t* value = row(0, y);
    for (int x = 0; x < width_; ++x) {
      const int before = (value[x] + value[std::max(x - 1, 0)]) / 2;
      const int after = (value[x] + value[std::min(x + 1, width_ - 1)]) / 2;
      row(1, y)[x] = static_cast<std::int16_t>(std::min({before, after, int{value[x]}}));
      row(2, y)[x] = static_cast<std::int16_t>(std::max({before, after, int{value[x]}}));
    }
  }
}

}  // namespace fdp_stereo
