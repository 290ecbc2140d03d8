// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/scaling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "images/area_resampling.hpp"
#include "images/colour.hpp"
#include "parallel.hpp"

namespace fdp_stereo {
namespace {

constexpr float kSameSurfacePx = 1.0F;    // of the small image
constexpr float kColourPerPixel = 16.0F;  // a difference of so many grey levels counts like a distance of 1 px

/// Position in the other image: pixel areas cover one another.
float moved(float position, double ratio) { return static_cast<float>((position + 0.5) * ratio - 0.5); }

Seeds scaled(Seeds seeds, double x, double y) {
  for (Seed& seed : seeds) {
    seed.x = moved(seed.x, x);
    seed.y = moved(seed.y, y);
    seed.d *= static_cast<float>(x);
  }
  return seeds;
}

/// What the loop over the full pixels reads.
struct Source {
  const cv::Mat& disparity;
  const cv::Mat& left_small;
  const cv::Mat& left_full;

  float at(int y, int x) const {
    return disparity.ptr<float>(std::clamp(y, 0, disparity.rows - 1))[std::clamp(x, 0, disparity.cols - 1)];
  }

  /// Disparity of the pixel among 3 x 3 that is nearest to (x, y) in place and colour; NaN if the nearest in place has
  /// none.
  float surface(float x, float y, const std::uint8_t* colour) const {
    const int channels = left_small.channels();
    const int centre_x = cvRound(x), centre_y = cvRound(y);
    float best = at(centre_y, centre_x);
    if (std::isnan(best)) return best;
    float nearest = 1e9F;
    for (int v = std::max(centre_y - 1, 0); v <= std::min(centre_y + 1, disparity.rows - 1); ++v) {
      for (int u = std::max(centre_x - 1, 0); u <= std::min(centre_x + 1, disparity.cols - 1); ++u) {
        const auto* pixel = left_small.ptr<std::uint8_t>(v) + u * channels;
        const float distance = std::abs(x - static_cast<float>(u)) + std::abs(y - static_cast<float>(v)) +
                               colourDistance(pixel, colour, channels) / kColourPerPixel;
        const float d = disparity.ptr<float>(v)[u];
        if (distance >= nearest || std::isnan(d)) continue;
        nearest = distance;
        best = d;
      }
    }
    return best;
  }

  /// Bilinear interpolation over those of the four pixels around (x, y) that lie on the surface.
  float interpolate(float x, float y, float surface) const {
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    const float fx = x - static_cast<float>(left), fy = y - static_cast<float>(top);
    const float weights[4] = {(1.0F - fx) * (1.0F - fy), fx * (1.0F - fy), (1.0F - fx) * fy, fx * fy};
    float sum = 0.0F, total = 0.0F;
    for (int i = 0; i < 4; ++i) {
      const float d = at(top + i / 2, left + i % 2);
      if (!(std::abs(d - surface) <= kSameSurfacePx)) continue;
      sum += weights[i] * d;
      total += weights[i];
    }
    return total > 0.0F ? sum / total : surface;
  }

  /// Disparity at (x, y) beside an edge or a hole; NaN where the nearest pixel has none.
  float beside(float x, float y, const std::uint8_t* colour) const {
    const float on = surface(x, y, colour);
    return std::isnan(on) ? on : interpolate(x, y, on);
  }
};

/// One row of the full image: most of its pixels lie between four that are on one surface.
class RowGrower {
 public:
  RowGrower(const Source& source, int width, double ratio) : source_(source), x_(width), left_(width), share_(width) {
    const int last = std::max(source.disparity.cols - 2, 0);
    for (int x = 0; x < width; ++x) {
      x_[x] = moved(static_cast<float>(x), ratio);
      left_[x] = std::clamp(static_cast<int>(std::floor(x_[x])), 0, last);
      share_[x] = std::clamp(x_[x] - static_cast<float>(left_[x]), 0.0F, 1.0F);
    }
    between_.resize(source.disparity.cols);
    smooth_.resize(source.disparity.cols);
  }

  void grow(int y, float small_y, float* full) {
    mix(small_y);
    const int channels = source_.left_full.channels();
    const auto* colours = source_.left_full.ptr<std::uint8_t>(y);
    for (std::size_t x = 0; x < x_.size(); ++x) {
      const int left = left_[x];
      full[x] = smooth_[left] != 0 ? between_[left] + share_[x] * (between_[left + 1] - between_[left])
                                   : source_.beside(x_[x], small_y, colours + x * channels);
    }
  }

 private:
  /// The row at small_y, and where it lies on one surface with its neighbours.
  void mix(float small_y) {
    const int rows = source_.disparity.rows, width = source_.disparity.cols;
    const int top = std::clamp(static_cast<int>(std::floor(small_y)), 0, std::max(rows - 2, 0));
    const float share = std::clamp(small_y - static_cast<float>(top), 0.0F, 1.0F);
    const auto* above = source_.disparity.ptr<float>(top);
    const auto* below = source_.disparity.ptr<float>(std::min(top + 1, rows - 1));
    for (int x = 0; x < width; ++x) between_[x] = above[x] + share * (below[x] - above[x]);
    smooth_[width - 1] = 0;
    for (int x = 0; x + 1 < width; ++x) {
      const float least = std::min(std::min(above[x], above[x + 1]), std::min(below[x], below[x + 1]));
      const float most = std::max(std::max(above[x], above[x + 1]), std::max(below[x], below[x + 1]));
      const float sum = above[x] + above[x + 1] + below[x] + below[x + 1];  // NaN where one of them is
      smooth_[x] = most - least <= kSameSurfacePx && sum == sum ? 1 : 0;
    }
  }

  const Source& source_;
  std::vector<float> x_;
  std::vector<int> left_;
  std::vector<float> share_, between_;
  std::vector<std::uint8_t> smooth_;
};

}  // namespace

Scaling::Scaling(cv::Size full, double scale)
    : full_(full),
      small_(std::max(1, cvRound(full.width * scale)), std::max(1, cvRound(full.height * scale))),
      x_(static_cast<double>(small_.width) / full.width),
      y_(static_cast<double>(small_.height) / full.height) {}

StereoPair Scaling::shrink(const StereoPair& pair) const {
  if (identity()) return pair;
  StereoPair small;
  small.left = shrinkByArea(pair.left, small_);
  small.right = shrinkByArea(pair.right, small_);
  const bool shared = pair.left.data == pair.left_grey.data;
  small.left_grey = shared ? small.left : shrinkByArea(pair.left_grey, small_);
  small.right_grey = shared ? small.right : shrinkByArea(pair.right_grey, small_);
  return small;
}

DisparityRange Scaling::shrink(DisparityRange range) const {
  const int min = static_cast<int>(std::floor(range.min * x_));
  const int max = static_cast<int>(std::ceil(range.max() * x_));
  return {min, max - min + 1};
}

Seeds Scaling::shrink(Seeds seeds) const { return identity() ? seeds : scaled(std::move(seeds), x_, y_); }

Seeds Scaling::grow(Seeds seeds) const { return identity() ? seeds : scaled(std::move(seeds), 1.0 / x_, 1.0 / y_); }

FeatureMatches Scaling::grow(FeatureMatches matches) const {
  if (identity()) return matches;
  for (FeatureMatch& match : matches) {
    for (cv::Point2f* point : {&match.left, &match.right}) {
      *point = {moved(point->x, 1.0 / x_), moved(point->y, 1.0 / y_)};
    }
  }
  return matches;
}

RowAlignment Scaling::grow(RowAlignment alignment) const {
  if (identity()) return alignment;
  alignment.model.size = full_;
  alignment.model.coefficients /= y_;
  for (double* px :
       {&alignment.rms_before_px, &alignment.rms_after_px, &alignment.sigma_px, &alignment.offset_rms_px}) {
    *px /= y_;
  }
  return alignment;
}

cv::Mat Scaling::grow(const cv::Mat& disparity, const cv::Mat& left_small, const cv::Mat& left_full,
                      DisparityRange range) const {
  const Source source{disparity, left_small, left_full};
  const auto min = static_cast<float>(range.min), max = static_cast<float>(range.max());
  cv::Mat full(full_, CV_32FC1);
  const auto factor = static_cast<float>(1.0 / x_);
  const auto makeGrower = [&] { return RowGrower(source, full.cols, x_); };
  parallelFor(full.rows, makeGrower, [&](int y, RowGrower& grower) {
    auto* row = full.ptr<float>(y);
    grower.grow(y, moved(static_cast<float>(y), y_), row);
    for (int x = 0; x < full.cols; ++x) {
      if (!std::isnan(row[x])) row[x] = std::clamp(row[x] * factor, min, max);
    }
  });
  return full;
}

}  // namespace fdp_stereo
