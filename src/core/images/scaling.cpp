// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/scaling.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "images/colour.hpp"

namespace fdp_stereo {
namespace {

constexpr float kSameSurfacePx = 1.0F;    // of the small image
constexpr float kColourPerPixel = 16.0F;  // a difference of so many grey levels counts like a distance of 1 px

cv::Mat resized(const cv::Mat& image, cv::Size size) {
  cv::Mat result;
  cv::resize(image, result, size, 0.0, 0.0, cv::INTER_AREA);
  return result;
}

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
  small.left = resized(pair.left, small_);
  small.right = resized(pair.right, small_);
  const bool shared = pair.left.data == pair.left_grey.data;
  small.left_grey = shared ? small.left : resized(pair.left_grey, small_);
  small.right_grey = shared ? small.right : resized(pair.right_grey, small_);
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
#pragma omp parallel for schedule(static)
  for (int y = 0; y < full.rows; ++y) {
    const float small_y = moved(static_cast<float>(y), y_);
    for (int x = 0; x < full.cols; ++x) {
      const float small_x = moved(static_cast<float>(x), x_);
      const auto* colour = left_full.ptr<std::uint8_t>(y) + x * left_full.channels();
      const float surface = source.surface(small_x, small_y, colour);
      const float d = std::isnan(surface) ? surface : source.interpolate(small_x, small_y, surface);
      full.ptr<float>(y)[x] = std::isnan(d) ? kInvalidDisparity : std::clamp(static_cast<float>(d / x_), min, max);
    }
  }
  return full;
}

}  // namespace fdp_stereo
