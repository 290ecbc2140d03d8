// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/simd.hpp"

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

/// Pairs are those from a pixel to its neighbours E, SE, S, SW, in this order.
constexpr int kPairDirections = 4;
/// Rows of a MoveTask are a multiple of this many floats long.
constexpr int kMoveLanes = 8;

/// One expansion move over a region of width x (rows - 2) pixels. All arrays are [rows][pitch] and hold the region from
/// (1, 1) on, with the ring of pixels around it, whose labels stay; pitch + kMoveLanes more floats can be read before
/// and after each, and what they hold beyond the image is finite. Weights of pairs that leave the image are 0.
///
/// With x = 1 (take the plane) or 0 (keep) the energy of the move is the sum of terminal[p] * x_p + the sum of
/// edge[d][p] * |x_p - x_q|, plus a constant.
struct MoveTask {
  int width;        // of the region
  int rows;         // of the region, and 2
  int pitch;        // at least width + 2, a multiple of kMoveLanes
  int x0, y0;       // image position of the first entry
  float threshold;  // tau
  const float* a;   // labels
  const float* b;
  const float* c;
  const float* cost;                      // data terms of the labels
  const float* weights[kPairDirections];  // lambda * w_pq, at the first pixel of the pair
  const float* inner;                     // 1 in the region, else 0
  float* keep[kPairDirections];           // cost of a pair when both keep their labels
  float* keep_sum;                        // cost and all pairs of a pixel
  float plane_a, plane_b, plane_c;        // the plane on offer
  const float* proposed;                  // its data terms, [rows - 2][width]
  float* da;                              // its difference to the labels
  float* db;
  float* dd;
  float* terminal;
  float* edge[kPairDirections];
  float* total;  // terminal and all edges of a pixel
  float* share;  // scratch
  float* lower;  // bounds of the best move
  float* upper;
  unsigned char* stale;  // scratch, [rows]
};

struct LocalExpansionKernels {
  /// Floats of scratch memory for a task whose target is at most width px wide.
  std::size_t (*planeCostScratch)(int width, int radius);
  void (*planeCosts)(const PlaneCostTask& task);
  /// Fills keep and keep_sum.
  void (*keepCosts)(const MoveTask& task);
  /// Fills da .. total.
  void (*moveTerms)(const MoveTask& task);
  /// Lets each pixel choose what pays for it alone while its neighbours stay, until nothing changes. From x = 1 in the
  /// region and 0 around it: what stays 1 contains every best move. From x = 0: it is contained in every best move.
  void (*improve)(const MoveTask& task, float* x);
  /// The energy of the move x = lower, less that of x = 0.
  double (*moveChange)(const MoveTask& task);
};

FDP_STEREO_DECLARE_KERNELS(LocalExpansionKernels, localExpansionKernels)

}  // namespace fdp_stereo
