// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hole_filling.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>
#include "arguments.hpp"

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

/// Pixels in holes of more than max_size px: CV_8UC1, 255.
cv::Mat largeHoles(const cv::Mat& disparity, int max_size) {
  cv::Mat labels, stats, centres;
  cv::connectedComponentsWithStats(~(disparity == disparity), labels, stats, centres, 4, CV_32S);
  cv::Mat large = cv::Mat::zeros(disparity.size(), CV_8UC1);
  for (int y = 0; y < large.rows; ++y) {
    for (int x = 0; x < large.cols; ++x) {
      const int hole = labels.at<int>(y, x);
      if (hole > 0 && stats.at<int>(hole, cv::CC_STAT_AREA) > max_size) large.at<std::uint8_t>(y, x) = 255;
    }
  }
  return large;
}

}  // namespace

void fillHoles(cv::Mat& disparity, int max_size) {
  requireMap(disparity, "hole filling");
  const cv::Mat large = max_size > 0 ? largeHoles(disparity, max_size) : cv::Mat();
  std::vector<bool> filled(disparity.rows);
  for (int y = 0; y < disparity.rows; ++y) filled[y] = fillRow(disparity.ptr<float>(y), disparity.cols);
  for (int y = 0; y < disparity.rows; ++y) {
    if (filled[y]) continue;
    const int donor = nearestFilledRow(filled, y);
    if (donor >= 0) disparity.row(donor).copyTo(disparity.row(y));
  }
  if (!large.empty()) disparity.setTo(kInvalidDisparity, large);
}

}  // namespace fdp_stereo
