// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>

#include <random>

#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace reference {

/// White noise of a type with 8-bit channels.
inline cv::Mat noise(int rows, int cols, int type, unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat image(rows, cols, type);
  for (int y = 0; y < rows; ++y) {
    for (int i = 0; i < cols * image.channels(); ++i) image.ptr(y)[i] = static_cast<unsigned char>(random() % 256);
  }
  return image;
}

/// Noise smoothed as an image is.
inline cv::Mat texture(int rows, int cols, int type, unsigned seed) {
  cv::Mat image;
  cv::GaussianBlur(noise(rows, cols, type, seed), image, {}, 1.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

/// Disparities in [low, high), a share of them NaN.
inline cv::Mat randomDisparity(int rows, int cols, double low, double high, double nan_share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(low, high);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  cv::Mat map(rows, cols, CV_32FC1);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      map.at<float>(y, x) = share(random) < nan_share ? kInvalidDisparity : static_cast<float>(value(random));
    }
  }
  return map;
}

/// A textured square before a textured wall, with the disparity of the left view.
struct RenderedPair {
  cv::Mat left;
  cv::Mat right;
  cv::Mat truth;
  cv::Mat visible;  ///< CV_8UC1: 255 where the right view sees the point too
};

inline RenderedPair renderPair(int rows, int cols, int wall_px, int square_px, unsigned seed, int type = CV_8UC3) {
  const cv::Mat wall = texture(rows, cols + 2 * wall_px, type, seed);
  const cv::Mat front = texture(rows, cols, type, seed + 1);
  RenderedPair pair;
  // The scene point at wall column u is left column u - wall_px and right column u - 2 wall_px.
  pair.left = wall.colRange(wall_px, wall_px + cols).clone();
  pair.right = wall.colRange(2 * wall_px, 2 * wall_px + cols).clone();
  pair.truth = cv::Mat(rows, cols, CV_32FC1, cv::Scalar(wall_px));
  pair.visible = cv::Mat(rows, cols, CV_8UC1, cv::Scalar(255));
  pair.visible.colRange(0, wall_px).setTo(0);
  const cv::Rect square(cols / 3, rows / 4, cols / 3, rows / 2);
  const cv::Rect hidden(square.x - (square_px - wall_px), square.y, square_px - wall_px, square.height);
  pair.visible(hidden).setTo(0);
  front(square).copyTo(pair.left(square));
  front(square).copyTo(pair.right(square - cv::Point(square_px, 0)));
  pair.truth(square).setTo(square_px);
  pair.visible(square).setTo(255);
  return pair;
}

/// The same to the bit, NaN included.
inline bool sameBits(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), a.cols * a.elemSize()) != 0) return false;
  }
  return true;
}

}  // namespace reference
}  // namespace fdp_stereo
