// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "fdp_stereo/matching_cost.hpp"
#include "reference/census_reference.hpp"

namespace fdp_stereo {
namespace reference {

inline double theta(double cost, double lambda) { return 1.0 - std::exp(-cost / lambda); }

inline double grey(const cv::Mat& image, int x, int y) {
  x = std::min(std::max(x, 0), image.cols - 1);
  y = std::min(std::max(y, 0), image.rows - 1);
  return image.at<unsigned char>(y, x);
}

/// Horizontal Sobel slope / 4: (1 2 1) weighted differences over two columns. Transpose for the vertical one.
inline double slope(const cv::Mat& image, int x, int y, bool vertical) {
  double sum = 0.0;
  for (int k = -1; k <= 1; ++k) {
    const double weight = k == 0 ? 2.0 : 1.0;
    sum += vertical ? weight * (grey(image, x + k, y + 1) - grey(image, x + k, y - 1))
                    : weight * (grey(image, x + 1, y + k) - grey(image, x - 1, y + k));
  }
  return sum / 4.0;
}

/// Mean absolute difference of the channels.
inline double colourDifference(const cv::Mat& left, int x, const cv::Mat& right, int x_right, int y) {
  const int channels = left.channels();
  double sum = 0.0;
  for (int c = 0; c < channels; ++c) {
    sum += std::abs(left.ptr(y)[x * channels + c] - right.ptr(y)[x_right * channels + c]);
  }
  return sum / channels;
}

inline cv::Mat toGrey(const cv::Mat& image) {
  cv::Mat converted = image;
  if (image.channels() == 3) cv::cvtColor(image, converted, cv::COLOR_BGR2GRAY);
  return converted;
}

/// Equation (8).
inline double rho(const StereoPair& pair, int x, int x_right, int y, double alpha) {
  const cv::Mat left = toGrey(pair.left);
  const cv::Mat right = toGrey(pair.right);
  const double gradient = std::abs(slope(left, x, y, false) - slope(right, x_right, y, false)) +
                          std::abs(slope(left, x, y, true) - slope(right, x_right, y, true));
  return (1.0 - alpha) * colourDifference(pair.left, x, pair.right, x_right, y) + alpha * gradient;
}

/// Equation (7), the weights divided by their sum.
inline double censusSum(const StereoPair& pair, int x, int x_right, int y, const MatchingCostParams& params) {
  double sum = 0.0;
  double weights = 0.0;
  for (int i = 0; i < params.scales; ++i) {
    cv::Mat left = pair.left_grey.clone();
    cv::Mat right = pair.right_grey.clone();
    const double sigma = params.scale_sigmas_px[i];
    if (sigma > 0.0) {
      cv::GaussianBlur(pair.left_grey, left, {}, sigma, 0, cv::BORDER_REPLICATE);
      cv::GaussianBlur(pair.right_grey, right, {}, sigma, 0, cv::BORDER_REPLICATE);
    }
    sum += params.scale_weights[i] *
           censusDistance(left, {x, y}, right, {x_right, y}, params.census.window_width, params.census.window_height);
    weights += params.scale_weights[i];
  }
  return sum / weights;
}

/// Distance of a value to the range that the other signal takes within half a pixel (Birchfield and Tomasi, 1998).
inline double halfPixelDistance(double value, const cv::Mat& image, int x, int y) {
  const double before = (grey(image, x, y) + grey(image, x - 1, y)) / 2.0;
  const double after = (grey(image, x, y) + grey(image, x + 1, y)) / 2.0;
  const double low = std::min({before, after, grey(image, x, y)});
  const double high = std::max({before, after, grey(image, x, y)});
  return std::max({0.0, value - high, low - value});
}

/// Cost of left (x, y) against right (x_right, y): equations (6) and (9) and their parts.
inline double matchingCost(const StereoPair& pair, int x, int x_right, int y, const MatchingCostParams& p) {
  const cv::Mat left = toGrey(pair.left);
  const cv::Mat right = toGrey(pair.right);
  switch (p.type) {
    case MatchingCostType::kRhoCensus:
      return p.rho_weight * theta(rho(pair, x, x_right, y, p.alpha), p.lambda_rho) +
             theta(censusSum(pair, x, x_right, y, p), p.lambda_census);
    case MatchingCostType::kAdCensus:
      return p.rho_weight * theta(colourDifference(pair.left, x, pair.right, x_right, y), p.lambda_ad) +
             theta(censusSum(pair, x, x_right, y, p), p.lambda_census);
    case MatchingCostType::kCensus:
      return theta(censusSum(pair, x, x_right, y, p), p.lambda_census);
    case MatchingCostType::kRho:
      return theta(rho(pair, x, x_right, y, p.alpha), p.lambda_rho);
    default:
      return theta(std::min(halfPixelDistance(grey(left, x, y), right, x_right, y),
                            halfPixelDistance(grey(right, x_right, y), left, x, y)),
                   p.lambda_ad);
  }
}

}  // namespace reference
}  // namespace fdp_stereo
