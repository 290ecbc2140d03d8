// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/speckle_filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "arguments.hpp"

namespace fdp_stereo {
namespace {

/// 4-connected regions, built from the runs of alike neighbours along the rows.
class Regions {
 public:
  Regions(const cv::Mat& disparity, float max_difference)
      : disparity_(disparity), max_difference_(max_difference), run_(disparity.size(), CV_32SC1) {
    for (int y = 0; y < disparity.rows; ++y) {
      findRuns(y);
      if (y > 0) joinRows(y);
    }
  }

  /// Calls drop(y, first, end) for each run of a region with fewer pixels.
  template <typename Drop>
  void visitSmaller(int least, Drop drop) {
    for (int y = 0; y < run_.rows; ++y) {
      const auto* run = run_.ptr<int>(y);
      for (int first = 0, end = 0; first < run_.cols; first = end) {
        while (end < run_.cols && run[end] == run[first]) ++end;
        if (size_[rootOf(run[first])] < least) drop(y, first, end);
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
    a = rootOf(a);
    b = rootOf(b);
    if (a == b) return;
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    size_[a] += size_[b];
  }

  int rootOf(int a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }

  const cv::Mat& disparity_;
  float max_difference_;
  cv::Mat run_;  // CV_32SC1, number of the run of each pixel
  std::vector<int> parent_, size_;
};

}  // namespace

void filterSpeckles(cv::Mat& disparity, const SpeckleFilterParams& params) {
  requireMap(disparity, "speckle filter");
  if (params.max_size <= 0) return;
  Regions regions(disparity, static_cast<float>(params.max_difference_px));
  regions.visitSmaller(params.max_size, [&](int y, int first, int end) {
    std::fill(disparity.ptr<float>(y) + first, disparity.ptr<float>(y) + end, kInvalidDisparity);
  });
}

}  // namespace fdp_stereo
