// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

constexpr int kConfidenceMeasures = 14;
constexpr int kConfidenceUnits = 12;
constexpr int kConfidenceBlock = 32;  ///< pixels at a time
constexpr int kConfidenceCell = 4;    ///< px, side of a cell of the surface

/// A logistic regression on hinges: unit j is max(0, bias_j + sum of weight_ji * measure_i).
struct ConfidenceModel {
  struct Unit {
    float bias;
    float weights[kConfidenceMeasures];
    float to_logit;      ///< share in log(p / (1 - p))
    float to_log_sigma;  ///< share in log(sigma / px)
  };
  Unit units[kConfidenceUnits];
  float logit;
  float log_sigma;
};

/// What is summed over cells, in whole numbers, so that sums over windows are exact in any order.
enum ConfidenceSum { kKnown, kSteps, kSquares, kRoughness, kMargin, kTexture, kConfidenceSums };
constexpr float kConfidenceLargestSteps = 4095.0F;  // the squares of a cell fit 32 bits
constexpr float kConfidenceMarginSteps = 8192.0F;

/// kConfidenceCell rows in cells of as many columns; the last column is repeated where that is needed.
struct ConfidenceCellRows {
  const float* disparity[kConfidenceCell];
  const float* margin[kConfidenceCell];
  const std::uint8_t* roughness[kConfidenceCell];
  const std::uint8_t* grey[kConfidenceCell];
  float lowest;  ///< disparity
  float steps;   ///< per px
  /// By cell: number of disparities; sums of the disparities above the lowest, each at most kConfidenceLargestSteps,
  /// and of their squares; of the roughness; of the margins in kConfidenceMarginSteps; of the differences of the left
  /// and the right neighbour.
  double* sums[kConfidenceSums];
};

/// What windows of cells tell, one entry per cell.
enum ConfidenceWindow {
  kRough,
  kMargins,
  kTextured,
  kNearSpread,
  kNearMean,
  kWideSpread,
  kWideMean,
  kShare,
  kConfidenceWindows
};

/// What the measures of one row come from: values of the pixels, and windows around them.
struct ConfidenceRow {
  const float* margin;
  const float* disparity;
  const float* right;                 ///< disparity of the other view, or null
  const std::int32_t* roughness_sum;  ///< 5 x 5
  const float* windows[kConfidenceWindows];
  float lowest, contrast;
  float* measures;  ///< measure i of pixel x is measures[i * stride + x]
  int stride;       ///< a multiple of kConfidenceBlock
};

struct ConfidenceKernels {
  void (*fillCells)(const ConfidenceCellRows& rows, int width);
  void (*fillMeasures)(const ConfidenceRow& row, int width);
  /// Of `width` pixels: confidence and sigma, 0 and NaN where the disparity is NaN. Measures are read up to the next
  /// multiple of kConfidenceBlock.
  void (*apply)(const ConfidenceModel& model, const float* measures, int stride, const float* disparity, int width,
                float* confidence, float* sigma);
  /// Steps from the left and from the upper neighbour, each at most 2 px, in 1/63 px.
  void (*roughness)(const float* row, const float* above, int width, std::uint8_t* to);
};
FDP_STEREO_DECLARE_KERNELS(ConfidenceKernels, confidenceKernels)

}  // namespace fdp_stereo
