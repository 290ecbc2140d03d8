// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd.hpp"

namespace fdp_stereo {

/// Planes that are filtered side by side.
constexpr int kPlaneBatch = 4;
/// Guide channels of the filter: 1 and three colours.
constexpr int kGuideChannels = 4;
/// Distinct entries of a symmetric 4 x 4 matrix: m00 m01 m02 m03 m11 m12 m13 m22 m23 m33.
constexpr int kSymmetricEntries = 10;

/// The guided-filter costs of kPlaneBatch planes over the target rectangle (x0, y0, width, height).
struct PlaneCostTask {
  // The raw costs: entry (f - first) * entries_per_px of pixel (x, y) is the cost of disparity f.
  const std::uint8_t* volume8;  // one of the two is null; [y][x][entry]
  const std::uint16_t* volume16;
  std::ptrdiff_t stride;  // entries from pixel to pixel, a multiple of 16
  int entries;
  float first;
  float entries_per_px;
  float scale;      // cost of one raw unit
  float threshold;  // costs are cut off here, after interpolation
  // The filter, whole image.
  int image_width;
  int image_height;
  int radius;
  const float* guide;    // [y][x][kGuideChannels]
  const float* inverse;  // [y][x][kSymmetricEntries]
  // What to compute.
  int x0, y0, width, height;
  float a[kPlaneBatch], b[kPlaneBatch], c[kPlaneBatch];
  float* out[kPlaneBatch];  // [height][width] each
  float* scratch;           // planeCostScratch() floats
};

/// Pairwise terms of one expansion move over the rectangle (x0, y0, width, height). Pairs are those from a pixel to
/// its neighbours E, SE, S, SW, in this order; both pixels must lie in the rectangle, other entries are 0.
constexpr int kPairDirections = 4;
struct PairwiseTask {
  int image_width;
  int x0, y0, width, height;
  const float* a;  // labels of the whole image
  const float* b;
  const float* c;
  const float* weights[kPairDirections];  // lambda * w_pq of the whole image, at the first pixel of the pair
  float threshold;                        // tau
  float* keep[kPairDirections];           // [height][width]: cost of the pair when both keep their labels
};

/// The move to `plane`, as terms of x = 1 (take the plane) or 0 (keep): sum of terminal[p] * x_p
/// + sum of edge[d][p] * |x_p - x_q|, plus a constant.
struct MoveTask {
  PairwiseTask pairs;            // with keep[] as filled by keepCosts
  float a, b, c;                 // the plane
  float* terminal;               // [height][width]
  float* edge[kPairDirections];  // [height][width]
  float* scratch;                // 4 * width * height floats
};

struct LocalExpansionKernels {
  /// Floats of scratch memory for a task whose target is at most width px wide.
  std::size_t (*planeCostScratch)(int width, int radius);
  void (*planeCosts)(const PlaneCostTask& task);
  void (*keepCosts)(const PairwiseTask& task);
  void (*moveTerms)(const MoveTask& task);
};

FDP_STEREO_DECLARE_KERNELS(LocalExpansionKernels, localExpansionKernels)

}  // namespace fdp_stereo
