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

inline float larger(float a, float b) { return a > b ? a : b; }
inline float smaller(float a, float b) { return a < b ? a : b; }
inline float bounded(float value, float half) { return value / (value + half); }

void fillMaps(const ConfidenceMapRow& row, int width) {
  const float* __restrict margin = row.margin;
  const float* __restrict disparity = row.disparity;
  std::uint16_t* __restrict to_margin = row.to_margin;
  std::uint16_t* __restrict to_steps = row.to_steps;
  std::int32_t* __restrict to_squares = row.to_squares;
  std::uint8_t* __restrict to_known = row.to_known;
  const float lowest = row.lowest, steps_per_px = row.steps;
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    const float d = disparity[x];
    const bool known = d == d;
    const float steps = (d - lowest) * steps_per_px + 0.5F;
    const auto whole = static_cast<std::int32_t>(known ? smaller(larger(steps, 0.0F), kConfidenceLargestSteps) : 0.0F);
    to_steps[x] = static_cast<std::uint16_t>(whole);
    to_squares[x] = whole * whole;
    to_known[x] = known ? 1 : 0;
    to_margin[x] = static_cast<std::uint16_t>(
        static_cast<std::int32_t>(smaller(larger(margin[x], 0.0F) * kConfidenceMarginSteps, 65535.0F)));
  }
  const std::uint8_t* __restrict grey = row.grey;
  std::uint8_t* __restrict to_texture = row.to_texture;
  to_texture[0] = to_texture[width - 1] = 0;
  for (int x = 1; x < width - 1; ++x) {
    const std::uint8_t a = grey[x - 1], b = grey[x + 1];
    to_texture[x] = static_cast<std::uint8_t>(a > b ? a - b : b - a);
  }
}

constexpr float kNearArea = 25.0F, kWideArea = 121.0F;  // pixels

void fillCosts(const ConfidenceSumRow& row, int width) {
  constexpr float kHalfMargin = 0.05F, kHalfRoughness = 0.1F * 63.0F, kHalfTexture = 8.0F;
  const ConfidenceSumRow r = row;
  float* __restrict margin = r.measures;
  float* __restrict rough_near = r.measures + 2 * r.stride;
  float* __restrict rough_wide = r.measures + 3 * r.stride;
  float* __restrict margins = r.measures + 4 * r.stride;
  float* __restrict texture = r.measures + 5 * r.stride;
  float* __restrict contrast = r.measures + 6 * r.stride;
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    margin[x] = bounded(larger(r.margin[x], 0.0F), kHalfMargin);
    rough_near[x] = bounded(static_cast<float>(r.roughness_near[x]), kHalfRoughness * kNearArea);
    rough_wide[x] = bounded(static_cast<float>(r.roughness_wide[x]), kHalfRoughness * kWideArea);
    margins[x] = bounded(static_cast<float>(r.margins[x]), kHalfMargin * kConfidenceMarginSteps * kNearArea);
    texture[x] = bounded(static_cast<float>(r.texture[x]), kHalfTexture * kNearArea);
    contrast[x] = r.contrast;
  }
}

void fillSurface(const ConfidenceSumRow& row, int width) {
  constexpr float kHalfDisparityPx = 16.0F, kFarPx = 100.0F, kHalfPx = 0.5F;
  const ConfidenceSumRow r = row;
  float* __restrict border = r.measures + 7 * r.stride;
  float* __restrict disparity = r.measures + 8 * r.stride;
  float* __restrict spread = r.measures + 9 * r.stride;
  float* __restrict offset = r.measures + 10 * r.stride;
  const float px = 1.0F / r.steps_per_px;
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    const float given = r.disparity[x];
    const float d = given == given ? given : r.lowest;
    border[x] = smaller(larger(static_cast<float>(x) - d, 0.0F), kFarPx) * (1.0F / kFarPx);
    disparity[x] = bounded(larger(d, 0.0F), kHalfDisparityPx);
    const float share = 1.0F / larger(static_cast<float>(r.known[x]), 1.0F);
    const float mean = static_cast<float>(r.steps[x]) * share;
    const float variance = larger(static_cast<float>(r.squares[x]) * share - mean * mean, 0.0F);
    spread[x] = bounded(__builtin_sqrtf(variance) * px, kHalfPx);
    const float e = d - r.lowest - mean * px;
    offset[x] = e / ((e < 0.0F ? -e : e) + kHalfPx);
  }
}

/// Of the views' disparities, at most 2 px, as a share of that; 0 without a right view.
void fillDistances(const ConfidenceSumRow& row, int width) {
  constexpr float kLargestPx = 2.0F;
  const float* __restrict disparity = row.disparity;
  const float* __restrict right = row.right;
  float* __restrict distance = row.measures + row.stride;
  const std::int32_t last = width - 1;
  if (right == nullptr) {
    for (int x = 0; x < width; ++x) distance[x] = 0.0F;
    return;
  }
  std::int32_t matches[kConfidenceBlock];
  for (int start = 0; start < width; start += kConfidenceBlock) {
    const int count = width - start < kConfidenceBlock ? width - start : kConfidenceBlock;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const float d = disparity[start + i];
      const auto match = static_cast<std::int32_t>(d == d ? static_cast<float>(start + i) - d + 0.5F : 0.0F);
      matches[i] = match < 0 ? 0 : (match > last ? last : match);
    }
    for (int i = 0; i < count; ++i) distance[start + i] = right[matches[i]];
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const float d = disparity[start + i], other = distance[start + i];
      const float e = d < other ? other - d : d - other;
      distance[start + i] = (e < kLargestPx ? e : kLargestPx) * (1.0F / kLargestPx);
    }
  }
}

void fillMeasures(const ConfidenceSumRow& row, int width) {
  fillCosts(row, width);
  fillSurface(row, width);
  fillDistances(row, width);
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

void apply(const ConfidenceModel& model, const float* measures, int stride, const float* disparity, int width,
           float* confidence, float* sigma) {
  float block_confidence[kConfidenceBlock], block_sigma[kConfidenceBlock];
  for (int start = 0; start < width; start += kConfidenceBlock) {
    applyToBlock(model, measures + start, stride, block_confidence, block_sigma);
    const int count = width - start < kConfidenceBlock ? width - start : kConfidenceBlock;
#pragma omp simd
    for (int x = 0; x < count; ++x) {
      const float d = disparity[start + x];
      confidence[start + x] = d == d ? block_confidence[x] : 0.0F;
      sigma[start + x] = d == d ? block_sigma[x] : d;
    }
  }
}

/// None to none is no step, none to a disparity the largest.
inline float stepBetween(float a, float b) {
  constexpr float kLargestStepPx = 2.0F;
  const float step = a < b ? b - a : a - b;
  const float bounded_step = step < kLargestStepPx ? step : kLargestStepPx;
  return a != a && b != b ? 0.0F : bounded_step;
}

void roughness(const float* __restrict row, const float* __restrict above, int width, std::uint8_t* __restrict to) {
  constexpr float kSteps = 63.0F;  // per px
  to[0] = static_cast<std::uint8_t>(static_cast<std::int32_t>(stepBetween(row[0], above[0]) * kSteps));
#pragma omp simd
  for (int x = 1; x < width; ++x) {
    const float steps = stepBetween(row[x], row[x - 1]) + stepBetween(row[x], above[x]);
    to[x] = static_cast<std::uint8_t>(static_cast<std::int32_t>(steps * kSteps));
  }
}

}  // namespace

const ConfidenceKernels& confidenceKernels() {
  static const ConfidenceKernels kernels = {fillMaps, fillMeasures, apply, roughness};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
