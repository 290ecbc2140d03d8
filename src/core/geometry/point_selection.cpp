// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/point_selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace {

constexpr int kReach = 2;             ///< px on either side
constexpr float kStepPx = 0.75F;      ///< of the disparity, on both sides
constexpr float kSamePx = 1.0F;       ///< neighbours of one surface differ by no more
constexpr int kFewestSupporters = 3;  ///< of the eight neighbours

float at(const cv::Mat& map, int x, int y) {
  const bool inside = x >= 0 && x < map.cols && y >= 0 && y < map.rows;
  return inside ? map.at<float>(y, x) : kInvalidDisparity;
}

/// The farthest known disparity within reach in a direction, NaN for none.
float beside(const cv::Mat& map, cv::Point pixel, cv::Point direction) {
  for (int i = kReach; i > 0; --i) {
    const float d = at(map, pixel.x + i * direction.x, pixel.y + i * direction.y);
    if (!std::isnan(d)) return d;
  }
  return kInvalidDisparity;
}

bool isStair(const cv::Mat& map, cv::Point pixel) {
  constexpr int kDirections[][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
  const float d = map.at<float>(pixel);
  return std::any_of(std::begin(kDirections), std::end(kDirections), [&](const int(&direction)[2]) {
    const cv::Point ahead(direction[0], direction[1]);
    const float rise = beside(map, pixel, ahead) - d;
    const float fall = d - beside(map, pixel, -ahead);
    return (rise > kStepPx && fall > kStepPx) || (rise < -kStepPx && fall < -kStepPx);
  });
}

bool isAlone(const cv::Mat& map, cv::Point pixel) {
  const float d = map.at<float>(pixel);
  int supporters = -1;  // the pixel itself
  for (int y = pixel.y - 1; y <= pixel.y + 1; ++y) {
    for (int x = pixel.x - 1; x <= pixel.x + 1; ++x) supporters += std::abs(at(map, x, y) - d) <= kSamePx ? 1 : 0;
  }
  return supporters < kFewestSupporters;
}

/// The best usable pixel of a square.
cv::Vec2i bestOf(const cv::Mat& usable, const cv::Mat& confidence, cv::Rect square) {
  const cv::Point centre = (square.tl() + square.br() - cv::Point(1, 1)) / 2;
  using Rank = std::tuple<float, int>;
  Rank best;
  cv::Vec2i pixel(-1, -1);
  for (int y = square.y; y < square.br().y; ++y) {
    for (int x = square.x; x < square.br().x; ++x) {
      if (usable.at<std::uint8_t>(y, x) == 0) continue;
      const float trust = confidence.empty() ? 0.0F : confidence.at<float>(y, x);
      const Rank rank(std::isnan(trust) ? 0.0F : trust, -std::abs(x - centre.x) - std::abs(y - centre.y));
      if (pixel[0] >= 0 && rank <= best) continue;
      best = rank;
      pixel = {x, y};
    }
  }
  return pixel;
}

}  // namespace

cv::Mat flyingPixels(const cv::Mat& disparity) {
  cv::Mat flying(disparity.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const cv::Point pixel(x, y);
      if (std::isnan(disparity.at<float>(pixel))) continue;
      if (isStair(disparity, pixel) || isAlone(disparity, pixel)) flying.at<std::uint8_t>(pixel) = 255;
    }
  }
  return flying;
}

cv::Mat bestPixels(const cv::Mat& usable, const cv::Mat& confidence, int side) {
  const cv::Rect image({0, 0}, usable.size());
  cv::Mat best((usable.rows + side - 1) / side, (usable.cols + side - 1) / side, CV_32SC2);
  for (int y = 0; y < best.rows; ++y) {
    for (int x = 0; x < best.cols; ++x) {
      const cv::Rect square = cv::Rect(x * side, y * side, side, side) & image;
      best.at<cv::Vec2i>(y, x) = bestOf(usable, confidence, square);
    }
  }
  return best;
}

}  // namespace fdp_stereo
