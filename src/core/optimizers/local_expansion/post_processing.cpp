// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/post_processing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "images/colour.hpp"
#include "parallel.hpp"

namespace fdp_stereo::local_expansion {
namespace {

struct WeightedPixel {
  float d;
  float weight;
  int x, y;
};

// table: the weights by colourThirds().
void collectWindow(const cv::Mat& image, const Labels& labels, cv::Point p, int radius,
                   const std::array<double, kThirds>& table, std::vector<WeightedPixel>& window) {
  const int channels = image.channels();
  const std::uint8_t* centre = image.ptr<std::uint8_t>(p.y) + p.x * channels;
  window.clear();
  for (int y = std::max(p.y - radius, 0); y <= std::min(p.y + radius, image.rows - 1); ++y) {
    const std::uint8_t* row = image.ptr<std::uint8_t>(y);
    for (int x = std::max(p.x - radius, 0); x <= std::min(p.x + radius, image.cols - 1); ++x) {
      const double weight = table[colourThirds(row + x * channels, centre, channels)];
      window.push_back({labels.plane(x, y).at(p.x, p.y), static_cast<float>(weight), x, y});
    }
  }
}

double weightOf(std::vector<WeightedPixel>::const_iterator first, std::vector<WeightedPixel>::const_iterator last) {
  double sum = 0.0;
  for (; first != last; ++first) sum += static_cast<double>(first->weight);
  return sum;
}

// Halves what may hold the median until one pixel is left.
Plane medianOf(std::vector<WeightedPixel>& window, const Labels& labels) {
  const auto before = [](const WeightedPixel& a, const WeightedPixel& b) {
    if (a.d != b.d) return a.d < b.d;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  const double half = 0.5 * weightOf(window.begin(), window.end());
  auto first = window.begin(), last = window.end();
  double below = 0.0;
  while (last - first > 1) {
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last, before);
    const double weight = weightOf(first, middle);
    if (below + weight >= half) {
      last = middle;
    } else {
      below += weight;
      first = middle;
    }
  }
  return labels.plane(first->x, first->y);
}

void fillRow(const cv::Mat& consistent, const cv::Mat& donors, int y, const Labels& before, Labels& labels) {
  const int width = labels.width;
  const std::uint8_t* ok = consistent.ptr<std::uint8_t>(y);
  const std::uint8_t* donor = donors.ptr<std::uint8_t>(y);
  std::vector<int> next(width + 1, -1);  // nearest donor at x or to its right
  for (int x = width - 1; x >= 0; --x) next[x] = donor[x] != 0 ? x : next[x + 1];
  int last = -1;
  for (int x = 0; x < width; ++x) {
    if (donor[x] != 0) last = x;
    if (ok[x] != 0) continue;
    const int right = next[x];
    int from = last >= 0 ? last : right;
    if (last >= 0 && right >= 0 && before.plane(right, y).at(x, y) < before.plane(last, y).at(x, y)) from = right;
    if (from >= 0) labels.planes.set(labels.index(x, y), before.plane(from, y));
  }
}

}  // namespace

cv::Mat consistentPixels(const Labels& own, const Labels& other, double max_difference_px) {
  cv::Mat result(own.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < own.height; ++y) {
    std::uint8_t* row = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < own.width; ++x) {
      const float d = own.disparity(x, y);
      const float match = std::round(static_cast<float>(x) - d);
      if (!(match >= 0.0F) || match > static_cast<float>(own.width - 1)) continue;
      const int mirrored = own.width - 1 - static_cast<int>(match);
      const float difference = std::fabs(d - other.disparity(mirrored, y));
      row[x] = static_cast<double>(difference) <= max_difference_px ? 255 : 0;
    }
  }
  return result;
}

void fillPlanes(const cv::Mat& consistent, Labels& labels) {
  cv::Mat donors;
  cv::erode(consistent, donors, cv::Mat::ones(3, 3, CV_8UC1));
  const Labels before = labels;
#pragma omp parallel for schedule(static)
  for (int y = 0; y < labels.height; ++y) fillRow(consistent, donors, y, before, labels);
}

void filterPlanes(const cv::Mat& image, const cv::Mat& consistent, int radius_px, double gamma, Labels& labels) {
  if (radius_px <= 0) return;
  const auto table = colourWeights(gamma);
  const Labels before = labels;
  using Window = std::vector<WeightedPixel>;
  parallelFor(
      labels.height, [] { return Window(); },
      [&](int y, Window& window) {
        for (int x = 0; x < labels.width; ++x) {
          if (consistent.at<std::uint8_t>(y, x) != 0) continue;
          collectWindow(image, before, {x, y}, radius_px, table, window);
          labels.planes.set(labels.index(x, y), medianOf(window, before));
        }
      });
}

cv::Mat disparityOf(const Labels& labels, DisparityRange range) {
  cv::Mat result(labels.size(), CV_32FC1);
  for (int y = 0; y < labels.height; ++y) {
    float* row = result.ptr<float>(y);
    for (int x = 0; x < labels.width; ++x) {
      row[x] = std::clamp(labels.disparity(x, y), static_cast<float>(range.min), static_cast<float>(range.max()));
    }
  }
  return result;
}

}  // namespace fdp_stereo::local_expansion
