// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/confidence_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

/// (1 + x / 256)^256 with x held within +-limit: exp() to some percent, the same bits everywhere.
inline float nearlyExp(float x, float limit) {
  const float held = x < -limit ? -limit : (x > limit ? limit : x);
  float power = 1.0F + held * (1.0F / 256.0F);
  for (int i = 0; i < 8; ++i) power *= power;
  return power;
}

void applyToBlock(const ConfidenceModel& model, const float* __restrict measures, int stride,
                  float* __restrict confidence, float* __restrict sigma) {
  constexpr float kLargestLogit = 12.0F;
  constexpr float kLargestLogSigma = 3.5F;  // 1/33 to 33 px
  float logit[kConfidenceBlock], log_sigma[kConfidenceBlock];
  for (int x = 0; x < kConfidenceBlock; ++x) {
    logit[x] = model.logit;
    log_sigma[x] = model.log_sigma;
  }
  for (const ConfidenceModel::Unit& unit : model.units) {
#pragma omp simd
    for (int x = 0; x < kConfidenceBlock; ++x) {
      float sum = unit.bias;
#pragma GCC unroll 16
      for (int i = 0; i < kConfidenceMeasures; ++i) sum += unit.weights[i] * measures[i * stride + x];
      const float hinge = sum > 0.0F ? sum : 0.0F;
      logit[x] += unit.to_logit * hinge;
      log_sigma[x] += unit.to_log_sigma * hinge;
    }
  }
#pragma omp simd
  for (int x = 0; x < kConfidenceBlock; ++x) {
    confidence[x] = 1.0F / (1.0F + nearlyExp(-logit[x], kLargestLogit));
    sigma[x] = nearlyExp(log_sigma[x], kLargestLogSigma);
  }
}

void apply(const ConfidenceModel& model, const float* measures, int stride, int count, float* confidence,
           float* sigma) {
  for (int x = 0; x < count; x += kConfidenceBlock) {
    applyToBlock(model, measures + x, stride, confidence + x, sigma + x);
  }
}

}  // namespace

const ConfidenceKernels& confidenceKernels() {
  static const ConfidenceKernels kernels = {apply};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
