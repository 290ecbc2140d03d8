// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "search_range.hpp"

#include <algorithm>
#include <cmath>

#include "text.hpp"

namespace fdp_stereo {

void checkRange(DisparityRange range, int width, const StereoGeometry& geometry, std::vector<std::string>& warnings) {
  const std::string given = text("min_disparity = ", range.min, ", disparity_range = ", range.count);
  if (range.min >= width || range.max() <= -width) {
    fail(given, ": no pixel of an image ", width, " px wide can have such a disparity; set min_disparity near 0");
  }
  if (range.count > width) {
    warnings.push_back(
        text(given, ": wider than the image, ", width, " px; a smaller disparity_range gives the same in less time"));
  }
  if (geometry.published(range.max()) <= 0.0) {
    warnings.push_back(text(given, ": with these principal points all of them lie beyond infinity, so there is no ",
                            "depth; set min_disparity to ", std::floor(geometry.cx_offset_px)));
  }
}

std::string visibleDistances(DisparityRange range, int width, const StereoGeometry& geometry) {
  const double nearest = geometry.depth(std::min(range.max(), width - 1));
  const double farthest = geometry.depth(range.min);
  if (std::isinf(nearest)) return "sees nothing: all disparities of the range lie beyond infinity";
  std::ostringstream told;
  told.precision(3);
  told << "sees from " << nearest << " m";
  if (std::isfinite(farthest)) told << " to " << farthest << " m";
  told << " (disparities " << range.min << " to " << range.max() << " px); a larger disparity_range sees nearer things";
  if (std::isfinite(farthest)) told << ", a smaller min_disparity farther ones";
  return told.str();
}

std::string depthErrors(double sigma_px, const StereoGeometry& geometry) {
  std::ostringstream told;
  told.precision(2);
  told << "depth error (1 sigma, " << sigma_px << " px of disparity):";
  const char* separator = " ";
  for (const double z : {1.0, 2.0, 5.0, 10.0}) {
    told << separator << z * z * sigma_px / (geometry.focal_px * geometry.baseline_m) << " m at " << z << " m";
    separator = ", ";
  }
  return told.str();
}

int disparityRangeFor(double nearest_m, int min_disparity, const StereoGeometry& geometry) {
  constexpr int kMultiple = 16, kLargest = 4096;
  const double largest = geometry.focal_px * geometry.baseline_m / nearest_m + geometry.cx_offset_px;
  const double count = std::ceil(largest) - min_disparity + 1.0;
  if (!(nearest_m > 0.0) || !(count <= kLargest)) {
    fail("nearest distance ", nearest_m, " m: needs ", count, " disparities, at most ", kLargest, " are searched; ask ",
         "for a larger distance, or match smaller images (pipeline_scale)");
  }
  return (std::max(static_cast<int>(count), 1) + kMultiple - 1) / kMultiple * kMultiple;
}

}  // namespace fdp_stereo
