// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/speckle_filter.hpp"

#include <cmath>
#include <vector>

namespace fdp_stereo {
namespace {

/// The 4-connected region of (y, x) as indices into the map.
void growRegion(const cv::Mat& disparity, int start, float max_difference, std::vector<std::uint8_t>& visited,
                std::vector<int>& region) {
  const auto* d = disparity.ptr<float>();
  region.assign(1, start);
  visited[start] = 1;
  for (std::size_t i = 0; i < region.size(); ++i) {
    const int p = region[i];
    const int x = p % disparity.cols;
    const int y = p / disparity.cols;
    const int neighbours[4] = {x > 0 ? p - 1 : -1, x + 1 < disparity.cols ? p + 1 : -1, y > 0 ? p - disparity.cols : -1,
                               y + 1 < disparity.rows ? p + disparity.cols : -1};
    for (const int q : neighbours) {
      if (q < 0 || visited[q] != 0 || !(std::abs(d[p] - d[q]) <= max_difference)) continue;
      visited[q] = 1;
      region.push_back(q);
    }
  }
}

}  // namespace

void filterSpeckles(cv::Mat& disparity, const SpeckleFilterParams& params) {
  if (params.max_size <= 0) return;
  if (!disparity.isContinuous()) disparity = disparity.clone();
  auto* d = disparity.ptr<float>();
  std::vector<std::uint8_t> visited(disparity.total(), 0);
  std::vector<int> region;
  for (int p = 0; p < static_cast<int>(disparity.total()); ++p) {
    if (visited[p] != 0 || std::isnan(d[p])) continue;
    growRegion(disparity, p, static_cast<float>(params.max_difference_px), visited, region);
    if (static_cast<int>(region.size()) >= params.max_size) continue;
    for (const int q : region) d[q] = kInvalidDisparity;
  }
}

}  // namespace fdp_stereo
