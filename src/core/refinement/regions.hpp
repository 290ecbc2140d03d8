// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// 4-connected regions of a disparity map, built from the runs of alike neighbours along the rows. The map must stay
/// as it is and where it is.
class Regions {
 public:
  Regions(const cv::Mat& disparity, float max_difference)
      : disparity_(disparity), max_difference_(max_difference), run_(disparity.size(), CV_32SC1) {
    for (int y = 0; y < disparity.rows; ++y) {
      findRuns(y);
      if (y > 0) joinRows(y);
    }
  }

  /// Runs are numbered from 0 on; some of those numbers stand for their regions.
  int runs() const { return static_cast<int>(size_.size()); }
  /// The run of each pixel of a row; pixels without disparity are runs, too.
  const int* row(int y) const { return run_.ptr<int>(y); }
  /// The region of a run, whose number is never larger.
  int regionOf(int run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }
  int size(int region) const { return size_[region]; }

  /// Takes the disparity of each region for which unwanted(region).
  template <typename Unwanted>
  void drop(cv::Mat& disparity, Unwanted&& unwanted) {
    for (int y = 0; y < run_.rows; ++y) {
      const int* run = row(y);
      for (int first = 0, end = 0; first < run_.cols; first = end) {
        while (end < run_.cols && run[end] == run[first]) ++end;
        if (!unwanted(regionOf(run[first]))) continue;
        std::fill(disparity.ptr<float>(y) + first, disparity.ptr<float>(y) + end, kInvalidDisparity);
      }
    }
  }

 private:
  bool alike(float a, float b) const { return std::abs(a - b) <= max_difference_; }

  void findRuns(int y) {
    const auto* d = disparity_.ptr<float>(y);
    auto* run = run_.ptr<int>(y);
    int current = -1;
    for (int x = 0; x < disparity_.cols; ++x) {
      if (x == 0 || !alike(d[x], d[x - 1])) {
        current = static_cast<int>(size_.size());
        parent_.push_back(current);
        size_.push_back(0);
      }
      run[x] = current;
      ++size_[current];
    }
  }

  void joinRows(int y) {
    const auto* d = disparity_.ptr<float>(y);
    const auto* above = disparity_.ptr<float>(y - 1);
    const auto* run = run_.ptr<int>(y);
    const auto* run_above = run_.ptr<int>(y - 1);
    int joined = -1, joined_above = -1;
    for (int x = 0; x < disparity_.cols; ++x) {
      if (!alike(d[x], above[x]) || (run[x] == joined && run_above[x] == joined_above)) continue;
      joined = run[x];
      joined_above = run_above[x];
      join(joined, joined_above);
    }
  }

  void join(int a, int b) {
    a = regionOf(a);
    b = regionOf(b);
    if (a == b) return;
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    size_[a] += size_[b];
  }

  const cv::Mat& disparity_;
  float max_difference_;
  cv::Mat run_;  // CV_32SC1, number of the run of each pixel
  std::vector<int> parent_, size_;
};

}  // namespace fdp_stereo
