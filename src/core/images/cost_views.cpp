// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/cost_views.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "images/colour.hpp"

namespace fdp_stereo {
namespace {

constexpr double kLeastBlurPx = 0.25;  // less does not change an image of 8 bits

/// 0 at `none` and beyond, 1 at `full` and beyond, a line between them.
double ramp(double value, double none, double full) { return std::clamp((value - none) / (full - none), 0.0, 1.0); }

/// Coarse pixels with edges that are still sharp: what compression leaves. Blur softens both.
double compression(const ImageQuality& quality) {
  if (quality.fine <= 0.0) return 1.0;
  return ramp(quality.fine, 0.11, 0.07) * ramp(quality.edges / quality.fine, 0.4, 0.6);
}

cv::Mat blurred(const cv::Mat& image, double sigma_px) {
  if (sigma_px < kLeastBlurPx) return image;
  cv::Mat result;
  cv::GaussianBlur(image, result, {}, sigma_px, 0.0, cv::BORDER_REPLICATE);
  return result;
}

/// The blur that makes the edges of `sharp` as soft as those of the other view; `ratio` is how much sharper they are.
double equalizingBlur(double ratio) {
  constexpr double kUnequal = 1.3;  // views of good cameras differ by less
  return ratio > kUnequal ? std::min(0.8 * std::sqrt(std::log(ratio / kUnequal)), 2.0) : 0.0;
}

}  // namespace

CostSmoothing smoothingFor(const ImageQuality& left, const ImageQuality& right) {
  CostSmoothing result;
  const double noise = ramp(std::max(left.noise, right.noise), 0.2, 0.4);
  const double coarse = std::min(compression(left), compression(right));
  if (right.edges > 0.0) result.left_px = equalizingBlur(left.edges / right.edges);
  if (left.edges > 0.0) result.right_px = equalizingBlur(right.edges / left.edges);
  result.census_px = std::max(1.0 * noise, 1.5 * coarse);
  result.gradient_px = 1.0 * coarse;
  result.lambda_factor = 1.0 + std::max(1.5 * noise, 0.5 * coarse);
  return result;
}

CostViews costViews(const StereoPair& pair, const MatchingCostParams& params) {
  CostViews views{pair, params};
  if (!params.adapt) return views;
  cv::Mat left_buffer, right_buffer;
  const cv::Mat& left = eightBitGrey(pair.left, pair.left_grey, left_buffer);
  const cv::Mat& right = eightBitGrey(pair.right, pair.right_grey, right_buffer);
  const CostSmoothing smoothing = smoothingFor(measureQuality(left), measureQuality(right));
  const bool colour = params.alpha < 1.0 || params.type == MatchingCostType::kAdCensus;
  views.params.lambda_rho *= smoothing.lambda_factor;
  const auto both = [](double a, double b) { return std::hypot(a, b); };
  views.pair.left = blurred(colour ? pair.left : left, both(smoothing.left_px, smoothing.gradient_px));
  views.pair.right = blurred(colour ? pair.right : right, both(smoothing.right_px, smoothing.gradient_px));
  views.pair.left_grey = blurred(pair.left_grey, both(smoothing.left_px, smoothing.census_px));
  views.pair.right_grey = blurred(pair.right_grey, both(smoothing.right_px, smoothing.census_px));
  return views;
}

}  // namespace fdp_stereo
