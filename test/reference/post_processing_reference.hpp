// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace reference {

inline bool bothNanOrNear(float a, float b, float tolerance) {
  return std::isnan(a) == std::isnan(b) && (std::isnan(a) || std::fabs(a - b) <= tolerance);
}

/// Number of pixels that differ, NaN being equal to NaN.
inline int differingPixels(const cv::Mat& a, const cv::Mat& b, float tolerance = 0.0F) {
  if (a.size() != b.size()) return static_cast<int>(std::max(a.total(), b.total()));
  int count = 0;
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x) {
      if (!bothNanOrNear(a.at<float>(y, x), b.at<float>(y, x), tolerance)) ++count;
    }
  }
  return count;
}

/// Label of the 4-connected region of every pixel, by relabelling until nothing changes; -1 where there is no
/// disparity.
inline std::vector<int> regionLabels(const cv::Mat& d, float max_difference) {
  std::vector<int> labels(d.total());
  for (int p = 0; p < static_cast<int>(labels.size()); ++p)
    labels[p] = std::isnan(d.at<float>(p / d.cols, p % d.cols)) ? -1 : p;
  for (bool changed = true; changed;) {
    changed = false;
    for (int y = 0; y < d.rows; ++y) {
      for (int x = 0; x < d.cols; ++x) {
        for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
          const cv::Point q(x + step.x, y + step.y);
          if (q.x >= d.cols || q.y >= d.rows) continue;
          int& a = labels[y * d.cols + x];
          int& b = labels[q.y * d.cols + q.x];
          if (a == b || a < 0 || b < 0) continue;
          if (std::fabs(d.at<float>(y, x) - d.at<float>(q.y, q.x)) > max_difference) continue;
          a = b = std::min(a, b);
          changed = true;
        }
      }
    }
  }
  return labels;
}

/// The disparity that the filling gives one empty pixel of its row; NaN for an empty row.
inline float filledFromRow(const cv::Mat& d, int x, int y) {
  float left = kInvalidDisparity;
  float right = kInvalidDisparity;
  for (int u = x; u >= 0 && std::isnan(left); --u) left = d.at<float>(y, u);
  for (int u = x; u < d.cols && std::isnan(right); ++u) right = d.at<float>(y, u);
  if (std::isnan(left)) return right;
  if (std::isnan(right)) return left;
  return std::min(left, right);
}

/// |I_p - I_q|: the mean over the channels.
inline double colourDistance(const cv::Mat& image, cv::Point p, cv::Point q) {
  const int channels = image.channels();
  int sum = 0;
  for (int c = 0; c < channels; ++c) {
    sum += std::abs(image.ptr(p.y)[p.x * channels + c] - image.ptr(q.y)[q.x * channels + c]);
  }
  return static_cast<double>(sum) / channels;
}

/// Twice the weight of the neighbours clearly (by more than `tolerance`) below and above `value`, and the weight of
/// all: a weighted median has neither above the whole.
struct MedianBalance {
  double twice_below = 0.0;
  double twice_above = 0.0;
  double all = 0.0;
  bool is_a_sample = false;
};
inline MedianBalance medianBalance(const cv::Mat& d, const cv::Mat& image, int x, int y, int radius, double gamma,
                                   float value, float tolerance) {
  MedianBalance balance;
  for (int v = std::max(0, y - radius); v <= std::min(d.rows - 1, y + radius); ++v) {
    for (int u = std::max(0, x - radius); u <= std::min(d.cols - 1, x + radius); ++u) {
      const float sample = d.at<float>(v, u);
      if (std::isnan(sample)) continue;
      const double weight = gamma > 0.0 ? std::exp(-colourDistance(image, {x, y}, {u, v}) / gamma) : 1.0;
      balance.all += weight;
      if (sample < value - tolerance) balance.twice_below += 2.0 * weight;
      if (sample > value + tolerance) balance.twice_above += 2.0 * weight;
      if (std::abs(sample - value) <= tolerance) balance.is_a_sample = true;
    }
  }
  return balance;
}

/// One pass of the bilateral mean along a row (or column) around (x, y), as DisparitySmoothingParams defines it.
inline float bilateralMean(const cv::Mat& d, const cv::Mat& image, int x, int y, bool along_row, int radius,
                           double gamma, double max_difference) {
  const float centre = d.at<float>(y, x);
  if (std::isnan(centre)) return centre;
  double sum = 0.0;
  double weights = 0.0;
  for (int k = -radius; k <= radius; ++k) {
    const cv::Point q = along_row ? cv::Point(x + k, y) : cv::Point(x, y + k);
    if (q.x < 0 || q.y < 0 || q.x >= d.cols || q.y >= d.rows || std::isnan(d.at<float>(q))) continue;
    const double e = (d.at<float>(q) - centre) / max_difference;
    const double colour = colourDistance(image, {x, y}, q) / gamma;
    const double weight = std::max(0.0, 1.0 - e * e) / (1.0 + colour * colour);
    sum += weight * d.at<float>(q);
    weights += weight;
  }
  return static_cast<float>(sum / weights);
}

}  // namespace reference
}  // namespace fdp_stereo
