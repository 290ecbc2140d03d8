// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "fdp_stereo/row_alignment.hpp"

namespace fdp_stereo::reference {

/// Lanczos kernel with three lobes.
inline double lanczos3(double t) {
  if (t == 0.0) return 1.0;
  if (std::abs(t) >= 3.0) return 0.0;
  const double a = CV_PI * t;
  return 3.0 * std::sin(a) * std::sin(a / 3.0) / (a * a);
}

/// One aligned value, pixel by pixel and without rounding the offset.
inline double alignedValue(const cv::Mat& right, const RowOffsetModel& model, int y, int x, int channel) {
  const double source = y - model.offsetAt(x, y);
  double sum = 0.0;
  double weights = 0.0;
  for (int row = static_cast<int>(std::floor(source)) - 2; row <= static_cast<int>(std::floor(source)) + 3; ++row) {
    const int inside = std::clamp(row, 0, right.rows - 1);
    const int i = right.channels() * x + channel;
    const double value = right.depth() == CV_8U ? right.ptr<uchar>(inside)[i] : right.ptr<ushort>(inside)[i];
    sum += lanczos3(row - source) * value;
    weights += lanczos3(row - source);
  }
  return std::clamp(sum / weights, 0.0, right.depth() == CV_8U ? 255.0 : 65535.0);
}

}  // namespace fdp_stereo::reference
