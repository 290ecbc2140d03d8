// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

struct ConfidenceKernels {
  /// Of `count` pixels, a multiple of kConfidenceBlock; measure i of pixel x is measures[i * stride + x].
  void (*apply)(const ConfidenceModel& model, const float* measures, int stride, int count, float* confidence,
                float* sigma);
};
FDP_STEREO_DECLARE_KERNELS(ConfidenceKernels, confidenceKernels)

}  // namespace fdp_stereo
