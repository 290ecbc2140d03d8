// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "costs/image_planes.hpp"

#include <algorithm>
#include <cmath>

namespace fdp_stereo {

void ImagePlanes::useChannels(const cv::Mat& image, double share) {
  image_ = image;
  channels_ = image.channels();
  for (int i = 0; i < 256; ++i) {
    table_[i] = static_cast<std::int16_t>(std::lround(i * share / channels_ * kUnitsPerGreyLevel));
  }
}

void ImagePlanes::useRho(const cv::Mat& image, const cv::Mat& grey, double alpha) {
  clear();
  if (alpha < 1.0) useChannels(image, 1.0 - alpha);
  grey_ = grey;
  gradient_factor_ = static_cast<int>(std::lround(alpha / 4.0 * kUnitsPerGreyLevel * 65536.0));
}

void ImagePlanes::useColour(const cv::Mat& image) {
  clear();
  useChannels(image, 1.0);
}

void ImagePlanes::useBirchfieldTomasi(const cv::Mat& grey) {
  clear();
  useChannels(grey, 1.0);
  birchfield_tomasi_ = true;
}

void ImagePlanes::fillChannels(int y, std::int16_t* planes) const {
  const auto* pixels = image_.ptr<std::uint8_t>(y);
  for (int c = 0; c < channels_; ++c) {
    for (int x = 0; x < image_.cols; ++x) planes[c * image_.cols + x] = table_[pixels[x * channels_ + c]];
  }
}

void ImagePlanes::fillGradient(int y, std::int16_t* horizontal, std::int16_t* vertical) const {
  const int last = grey_.cols - 1;
  const auto* above = grey_.ptr<std::uint8_t>(std::max(y - 1, 0));
  const auto* here = grey_.ptr<std::uint8_t>(y);
  const auto* below = grey_.ptr<std::uint8_t>(std::min(y + 1, grey_.rows - 1));
  const auto slope = [&](int x, int left, int right) {
    const int dx = above[right] - above[left] + 2 * (here[right] - here[left]) + below[right] - below[left];
    const int dy = below[left] - above[left] + 2 * (below[x] - above[x]) + below[right] - above[right];
    horizontal[x] = static_cast<std::int16_t>((dx * gradient_factor_ + 32768) >> 16);
    vertical[x] = static_cast<std::int16_t>((dy * gradient_factor_ + 32768) >> 16);
  };
  slope(0, 0, std::min(1, last));
  for (int x = 1; x < last; ++x) slope(x, x - 1, x + 1);
  slope(last, std::max(last - 1, 0), last);
}

namespace {

void fillInterval(const std::int16_t* value, int width, std::int16_t* smallest, std::int16_t* largest) {
  for (int x = 0; x < width; ++x) {
    const int before = (value[x] + value[std::max(x - 1, 0)]) / 2;
    const int after = (value[x] + value[std::min(x + 1, width - 1)]) / 2;
    smallest[x] = static_cast<std::int16_t>(std::min({before, after, int{value[x]}}));
    largest[x] = static_cast<std::int16_t>(std::max({before, after, int{value[x]}}));
  }
}

}  // namespace

void ImagePlanes::fillRow(int y, std::int16_t* planes) const {
  const int width = channels_ > 0 ? image_.cols : grey_.cols;
  if (channels_ > 0) fillChannels(y, planes);
  std::int16_t* beyond = planes + static_cast<std::ptrdiff_t>(channels_) * width;
  if (gradient_factor_ > 0) fillGradient(y, beyond, beyond + width);
  if (birchfield_tomasi_) fillInterval(planes, width, beyond, beyond + width);
}

}  // namespace fdp_stereo
