// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simd/simd.hpp"

namespace fdp_stereo {

constexpr int kConfidenceMeasures = 11;
constexpr int kConfidenceUnits = 12;
constexpr int kConfidenceBlock = 32;  ///< pixels at a time

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

/// One row in whole numbers, so that sums over windows are exact in any order.
struct ConfidenceMapRow {
  const float* margin;
  const float* disparity;
  const std::uint8_t* grey;
  float lowest;              ///< disparity
  float steps;               ///< per px
  std::uint16_t* to_margin;  ///< in kConfidenceMarginSteps
  std::uint8_t* to_texture;  ///< difference of the left and the right neighbour
  std::uint8_t* to_known;    ///< 1 where there is a disparity
  std::uint16_t* to_steps;   ///< disparity above the lowest, at most kConfidenceLargestSteps; 0 where there is none
  std::int32_t* to_squares;  ///< of these
};
constexpr float kConfidenceMarginSteps = 8192.0F;
constexpr float kConfidenceLargestSteps = 4095.0F;  // 11 x 11 squares fit 32 bits

/// What the measures of one row come from: values of the pixels, and sums over windows around them.
struct ConfidenceSumRow {
  const float* margin;
  const float* disparity;
  const float* right;  ///< disparity of the other view, or null
  const std::int32_t* roughness_near;
  const std::int32_t* roughness_wide;
  const std::int32_t* margins;
  const std::int32_t* texture;
  const std::int32_t* known;
  const std::int32_t* steps;
  const std::int32_t* squares;
  float lowest, steps_per_px, contrast;
  float* measures;  ///< measure i of pixel x is measures[i * stride + x]
  int stride;
};

struct ConfidenceKernels {
  void (*fillMaps)(const ConfidenceMapRow& row, int width);
  void (*fillMeasures)(const ConfidenceSumRow& row, int width);
  /// Of `width` pixels: confidence and sigma, 0 and NaN where the disparity is NaN. Measures are read up to the next
  /// multiple of kConfidenceBlock.
  void (*apply)(const ConfidenceModel& model, const float* measures, int stride, const float* disparity, int width,
                float* confidence, float* sigma);
  /// Steps from the left and from the upper neighbour, each at most 2 px, in 1/63 px.
  void (*roughness)(const float* row, const float* above, int width, std::uint8_t* to);
};
FDP_STEREO_DECLARE_KERNELS(ConfidenceKernels, confidenceKernels)

}  // namespace fdp_stereo
