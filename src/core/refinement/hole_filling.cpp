// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hole_filling.hpp"

#include <algorithm>
#include <cmath>

namespace fdp_stereo {
namespace {

/// Fills between valid pixels of one row; false where the row has none.
bool fillRow(float* row, int width) {
  int x = 0;
  float before = kInvalidDisparity;
  while (x < width) {
    if (!std::isnan(row[x])) {
      before = row[x++];
      continue;
    }
    int end = x;
    while (end < width && std::isnan(row[end])) ++end;
    const float after = end < width ? row[end] : kInvalidDisparity;
    // fmin ignores a NaN: at the image border the one side that exists counts.
    std::fill(row + x, row + end, std::fmin(before, after));
    x = end;
  }
  return width > 0 && !std::isnan(row[0]);
}

/// The nearest row that has disparities, the upper one on ties; -1 for none.
int nearestFilledRow(const std::vector<bool>& filled, int y) {
  const int rows = static_cast<int>(filled.size());
  for (int step = 1; step < rows; ++step) {
    if (y - step >= 0 && filled[y - step]) return y - step;
    if (y + step < rows && filled[y + step]) return y + step;
  }
  return -1;
}

}  // namespace

void fillHoles(cv::Mat& disparity) {
  std::vector<bool> filled(disparity.rows);
  for (int y = 0; y < disparity.rows; ++y) filled[y] = fillRow(disparity.ptr<float>(y), disparity.cols);
  for (int y = 0; y < disparity.rows; ++y) {
    if (filled[y]) continue;
    const int donor = nearestFilledRow(filled, y);
    if (donor >= 0) disparity.row(donor).copyTo(disparity.row(y));
  }
}

}  // namespace fdp_stereo
