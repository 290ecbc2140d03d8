// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fdp_stereo/types.hpp"
#include "parallel.hpp"

namespace fdp_stereo {

/// 4-connected regions of a disparity map, built from the runs of alike neighbours along the rows. Pixels without
/// disparity beside each other are a region, too.
class Regions {
 public:
  Regions(const cv::Mat& disparity, float max_difference)
      : disparity_(disparity),
        max_difference_(max_difference),
        run_(disparity.size(), CV_32SC1),
        first_(disparity.rows + 1) {
    parallelFor(disparity.rows, [&](int y) { first_[y + 1] = findRuns(y); });
    for (int y = 0; y < disparity.rows; ++y) first_[y + 1] += first_[y];
    parent_.resize(first_.back());
    size_.resize(first_.back());
    const int strips = (disparity.rows + kStripRows - 1) / kStripRows;
    const auto join_strip = [&](int strip) {
      const int top = strip * kStripRows, bottom = std::min(top + kStripRows, disparity.rows);
      for (int y = top; y < bottom; ++y) {
        numberRuns(y);
        if (y > top) joinRows(y);
      }
    };
    parallelFor(strips, join_strip, 1);
    for (int strip = 1; strip < strips; ++strip) joinRows(strip * kStripRows);
    for (int run = 0; run < runs(); ++run) parent_[run] = parent_[parent_[run]];  // which is no larger: a region
  }

  /// Runs are numbered from 0 on; some of those numbers stand for their regions.
  int runs() const { return static_cast<int>(size_.size()); }
  /// The run of each pixel of a row.
  const int* row(int y) const { return run_.ptr<int>(y); }
  /// The region of a run, whose number is never larger.
  int regionOf(int run) const { return parent_[run]; }
  int size(int region) const { return size_[region]; }

  /// Takes the disparity of each region for which unwanted(region).
  template <typename Unwanted>
  void drop(cv::Mat& disparity, Unwanted&& unwanted) const {
    parallelFor(run_.rows, [&](int y) {
      const int* run = row(y);
      for (int first = 0, end = 0; first < run_.cols; first = end) {
        while (end < run_.cols && run[end] == run[first]) ++end;
        if (!unwanted(regionOf(run[first]))) continue;
        std::fill(disparity.ptr<float>(y) + first, disparity.ptr<float>(y) + end, kInvalidDisparity);
      }
    });
  }

 private:
  static constexpr int kStripRows = 32;  // that a thread joins by itself

  bool alike(float a, float b) const { return std::abs(a - b) <= max_difference_; }

  /// Numbers the runs of a row from 0 on; returns how many there are.
  int findRuns(int y) {
    const auto* d = disparity_.ptr<float>(y);
    auto* run = run_.ptr<int>(y);
    int current = 0;
    run[0] = 0;
    for (int x = 1; x < disparity_.cols; ++x) {
      const bool same = alike(d[x], d[x - 1]) || (std::isnan(d[x]) && std::isnan(d[x - 1]));
      current += same ? 0 : 1;
      run[x] = current;
    }
    return current + 1;
  }

  /// From those of the whole map.
  void numberRuns(int y) {
    auto* run = run_.ptr<int>(y);
    for (int i = first_[y]; i < first_[y + 1]; ++i) parent_[i] = i;
    for (int x = 0; x < disparity_.cols; ++x) ++size_[run[x] += first_[y]];
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

  int rootOf(int run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }

  void join(int a, int b) {
    a = rootOf(a);
    b = rootOf(b);
    if (a == b) return;
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    size_[a] += size_[b];
  }

  const cv::Mat& disparity_;
  float max_difference_;
  cv::Mat run_;             // CV_32SC1, number of the run of each pixel
  std::vector<int> first_;  // run of each row, and one more
  std::vector<int> parent_, size_;
};

}  // namespace fdp_stereo
