// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/speckle_filter.hpp"

#include <cmath>
#include <vector>

namespace fdp_stereo {
namespace {

/// The 4-connected regions of a map, one after another; keeps its memory.
class RegionFinder {
 public:
  RegionFinder(const cv::Mat& disparity, float max_difference, std::size_t kept)
      : disparity_(disparity), max_difference_(max_difference), kept_(kept), visited_(disparity.total(), 0) {}

  bool visited(int p) const { return visited_[p] != 0; }

  /// The region of pixel `start`, which no region before held: its pixels as indices into the map, or `kept` of them.
  const std::vector<int>& grow(int start) {
    region_.clear();
    next_.clear();
    visit(start);
    while (!next_.empty()) {
      frontier_.swap(next_);
      next_.clear();
      for (const int p : frontier_) visitNeighbours(p);
    }
    return region_;
  }

 private:
  void visit(int p) {
    visited_[p] = 1;
    next_.push_back(p);
    if (region_.size() < kept_) region_.push_back(p);
  }

  void visitNeighbours(int p) {
    const int cols = disparity_.cols;
    const int x = p % cols, y = p / cols;
    if (x > 0) visitAlike(p, p - 1);
    if (x + 1 < cols) visitAlike(p, p + 1);
    if (y > 0) visitAlike(p, p - cols);
    if (y + 1 < disparity_.rows) visitAlike(p, p + cols);
  }

  void visitAlike(int p, int q) {
    const auto* d = disparity_.ptr<float>();
    if (visited_[q] == 0 && std::abs(d[p] - d[q]) <= max_difference_) visit(q);
  }

  const cv::Mat& disparity_;
  float max_difference_;
  std::size_t kept_;
  std::vector<std::uint8_t> visited_;
  std::vector<int> region_, frontier_, next_;
};

}  // namespace

void filterSpeckles(cv::Mat& disparity, const SpeckleFilterParams& params) {
  if (params.max_size <= 0) return;
  if (!disparity.isContinuous()) disparity = disparity.clone();
  auto* d = disparity.ptr<float>();
  const auto max_size = static_cast<std::size_t>(params.max_size);
  RegionFinder regions(disparity, static_cast<float>(params.max_difference_px), max_size);
  for (int p = 0; p < static_cast<int>(disparity.total()); ++p) {
    if (regions.visited(p) || std::isnan(d[p])) continue;
    const std::vector<int>& region = regions.grow(p);
    if (region.size() >= max_size) continue;
    for (const int q : region) d[q] = kInvalidDisparity;
  }
}

}  // namespace fdp_stereo
