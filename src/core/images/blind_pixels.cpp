// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/blind_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "fdp_stereo/types.hpp"
#include "parallel.hpp"

namespace fdp_stereo {
namespace {

/// 255 in every window of side x side px whose values differ by at most `difference`.
cv::Mat flatWindows(const cv::Mat& grey, int side, double difference) {
  const cv::Mat window(side, side, CV_8UC1, cv::Scalar(1));
  cv::Mat largest, smallest, flat;
  cv::dilate(grey, largest, window);
  cv::erode(grey, smallest, window);
  cv::dilate(largest - smallest <= difference, flat, window);
  return flat;
}

/// Marks what is reached from (x, y) by steps of (dx, dy) through black.
void markRay(const cv::Mat& black, int x, int y, int dx, int dy, cv::Mat& reached) {
  for (; x >= 0 && y >= 0 && x < black.cols && y < black.rows && black.at<std::uint8_t>(y, x) != 0; x += dx, y += dy) {
    reached.at<std::uint8_t>(y, x) = 255;
  }
}

/// Mirrors the row at the nearest pixel that is not masked; false where there is none.
bool extendRow(const std::uint8_t* masked, std::size_t bytes, int width, std::uint8_t* row) {
  std::vector<int> source(width);
  for (int x = 0, before = -1; x < width; ++x) source[x] = before = masked[x] == 0 ? x : before;
  for (int x = width - 1, after = -1; x >= 0; --x) {
    if (masked[x] == 0) after = x;
    if (source[x] < 0 || (after >= 0 && after - x < x - source[x])) source[x] = after;
  }
  if (source[0] < 0) return false;
  for (int x = 0; x < width; ++x) {
    const int mirrored = std::clamp(2 * source[x] - x, 0, width - 1);
    const int from = masked[mirrored] == 0 ? mirrored : source[x];
    if (from != x) std::copy_n(row + from * bytes, bytes, row + x * bytes);
  }
  return true;
}

}  // namespace

cv::Mat blindPixels(const cv::Mat& grey) { return flatWindows(grey, 5, 0.0) | flatWindows(grey, 15, 1.0); }

cv::Mat blackFrame(const cv::Mat& grey) {
  constexpr int kBlack = 1;             // grey levels at most: the compression of an image leaves no more
  constexpr double kLeastShare = 1e-3;  // of the image
  const cv::Rect all(cv::Point(), grey.size());
  cv::Mat black = grey <= kBlack;
  const auto touches = [&](const cv::Rect& side) { return cv::countNonZero(black(side & all)) > 0; };
  if (!touches({0, 0, 1, grey.rows}) && !touches({grey.cols - 1, 0, 1, grey.rows}) && !touches({0, 0, grey.cols, 1}) &&
      !touches({0, grey.rows - 1, grey.cols, 1})) {
    return {};
  }
  black &= blindPixels(grey);
  cv::Mat reached = cv::Mat::zeros(grey.size(), CV_8UC1);
  for (int y = 0; y < grey.rows; ++y) {
    markRay(black, 0, y, 1, 0, reached);
    markRay(black, grey.cols - 1, y, -1, 0, reached);
  }
  for (int x = 0; x < grey.cols; ++x) {
    markRay(black, x, 0, 0, 1, reached);
    markRay(black, x, grey.rows - 1, 0, -1, reached);
  }
  return cv::countNonZero(reached) < kLeastShare * static_cast<double>(grey.total()) ? cv::Mat() : reached;
}

cv::Mat extendUnder(const cv::Mat& mask, const cv::Mat& image) {
  if (mask.empty()) return image;
  cv::Mat extended = image.clone();
  int last = -1;  // row with pixels of its own
  for (int y = 0; y < image.rows; ++y) {
    if (!extendRow(mask.ptr<std::uint8_t>(y), image.elemSize(), image.cols, extended.ptr<std::uint8_t>(y))) continue;
    for (int empty = last + 1; empty < y; ++empty) {
      extended.row(last < 0 || 2 * empty > last + y ? y : last).copyTo(extended.row(empty));
    }
    last = y;
  }
  for (int empty = last + 1; last >= 0 && empty < image.rows; ++empty) extended.row(last).copyTo(extended.row(empty));
  return extended;
}

void dropUnexplained(const cv::Mat& blind, cv::Mat& disparity) {
  constexpr float kTolerancePx = 1.0F;
  using Row = std::vector<float>;  // the next known disparity from x on
  const auto explain_row = [&](int y, Row& after) {
    const auto* hidden = blind.ptr<std::uint8_t>(y);
    auto* d = disparity.ptr<float>(y);
    const auto carry = [&](int x, int neighbour, float known) {  // from one pixel to the next, but not out of a run
      if (hidden[x] != 0) return known;
      if (!std::isnan(d[x])) return d[x];
      return hidden[neighbour] != 0 ? kInvalidDisparity : known;
    };
    const int last = blind.cols - 1;
    after[last + 1] = kInvalidDisparity;
    for (int x = last; x >= 0; --x) after[x] = carry(x, std::min(x + 1, last), after[x + 1]);
    float before = kInvalidDisparity;
    for (int x = 0; x <= last; ++x) {
      before = carry(x, std::max(x - 1, 0), before);
      if (hidden[x] == 0) continue;
      const bool explained =
          d[x] >= std::min(before, after[x]) - kTolerancePx && d[x] <= std::max(before, after[x]) + kTolerancePx;
      if (std::isnan(before) || std::isnan(after[x]) || !explained) d[x] = kInvalidDisparity;
    }
  };
  parallelFor(
      blind.rows, [&] { return Row(blind.cols + 1); }, explain_row);
}

}  // namespace fdp_stereo
