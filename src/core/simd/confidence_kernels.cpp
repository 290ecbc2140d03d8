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

static_assert(kConfidenceCell == 4, "fillCells adds four columns");

/// Sums of the columns of a block over the rows.
struct ColumnSums {
  std::int32_t of[kConfidenceSums][kConfidenceBlock] = {};

  void addDisparities(const float* __restrict disparity, float lowest, float steps_per_px, int count) {
#pragma omp simd
    for (int x = 0; x < count; ++x) {
      const float d = disparity[x];
      const bool has = d == d;
      const float wanted = (d - lowest) * steps_per_px + 0.5F;
      const auto whole = static_cast<std::int32_t>(has ? smaller(larger(wanted, 0.0F), kConfidenceLargestSteps) : 0.0F);
      of[kKnown][x] += has ? 1 : 0;
      of[kSteps][x] += whole;
      of[kSquares][x] += whole * whole;
    }
  }

  void addMargins(const float* __restrict margin, const std::uint8_t* __restrict roughness, int count) {
#pragma omp simd
    for (int x = 0; x < count; ++x) {
      of[kMargin][x] += static_cast<std::int32_t>(smaller(larger(margin[x], 0.0F) * kConfidenceMarginSteps, 65535.0F));
      of[kRoughness][x] += roughness[x];
    }
  }

  /// From `first` on, which has a left neighbour.
  void addTexture(const std::uint8_t* __restrict grey, int first, int count) {
#pragma omp simd
    for (int x = first; x < count; ++x) {
      const std::int32_t step = grey[x + 1] - grey[x - 1];
      of[kTexture][x] += step < 0 ? -step : step;
    }
  }

  /// Repeats the last of `count` columns in the rest of its cell.
  void fillUp(int count) {
    for (auto& sums : of) {
      for (int x = count; x % kConfidenceCell != 0; ++x) sums[x] = sums[count - 1];
    }
  }
};

void fillCells(const ConfidenceCellRows& rows, int width) {
  for (int start = 0; start < width; start += kConfidenceBlock) {
    const int count = width - start < kConfidenceBlock ? width - start : kConfidenceBlock;
    ColumnSums columns;
    for (int k = 0; k < kConfidenceCell; ++k) {
      columns.addDisparities(rows.disparity[k] + start, rows.lowest, rows.steps, count);
      columns.addMargins(rows.margin[k] + start, rows.roughness[k] + start, count);
      columns.addTexture(rows.grey[k] + start, start == 0 ? 1 : 0, start + count == width ? count - 1 : count);
    }
    columns.fillUp(count);
    for (int sum = 0; sum < kConfidenceSums; ++sum) {
      double* __restrict cells = rows.sums[sum] + start / kConfidenceCell;
      for (int i = 0; i * kConfidenceCell < count; ++i) {
        const std::int32_t* four = columns.of[sum] + i * kConfidenceCell;
        cells[i] = four[0] + four[1] + four[2] + four[3];
      }
    }
  }
}

/// The value of its cell for every pixel.
void spreadCells(const float* __restrict cells, int width, float* __restrict pixels) {
  for (int cell = 0; cell * kConfidenceCell < width; ++cell) {
    for (int k = 0; k < kConfidenceCell; ++k) pixels[cell * kConfidenceCell + k] = cells[cell];
  }
}

void fillPixels(const ConfidenceRow& row, int width) {
  constexpr float kHalfMargin = 0.05F, kHalfRoughness = 0.1F * 63.0F, kNearArea = 25.0F;
  constexpr float kHalfDisparityPx = 16.0F, kFarPx = 100.0F;
  const ConfidenceRow r = row;
  float* __restrict margin = r.measures;
  float* __restrict rough = r.measures + 2 * r.stride;
  float* __restrict contrast = r.measures + 6 * r.stride;
  float* __restrict border = r.measures + 7 * r.stride;
  float* __restrict disparity = r.measures + 8 * r.stride;
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    const float given = r.disparity[x];
    const float d = given == given ? given : r.lowest;
    margin[x] = bounded(larger(r.margin[x], 0.0F), kHalfMargin);
    rough[x] = bounded(static_cast<float>(r.roughness_sum[x]), kHalfRoughness * kNearArea);
    contrast[x] = r.contrast;
    border[x] = smaller(larger(static_cast<float>(x) - d, 0.0F), kFarPx) * (1.0F / kFarPx);
    disparity[x] = bounded(larger(d, 0.0F), kHalfDisparityPx);
  }
}

/// Of the disparities from the mean around, which `offset` holds before.
void subtractMeans(const ConfidenceRow& row, int width, float* __restrict offset) {
  constexpr float kHalfPx = 0.5F;
  const float* __restrict disparity = row.disparity;
  const float lowest = row.lowest;
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    const float given = disparity[x];
    const float e = (given == given ? given : lowest) - offset[x];
    offset[x] = e / ((e < 0.0F ? -e : e) + kHalfPx);
  }
}

void fillWindows(const ConfidenceRow& row, int width) {
  constexpr int kMeasureOf[kConfidenceWindows] = {3, 4, 5, 9, 10, 11, 12, 13};
  for (int i = 0; i < kConfidenceWindows; ++i) {
    spreadCells(row.windows[i], width, row.measures + kMeasureOf[i] * row.stride);
  }
  subtractMeans(row, width, row.measures + kMeasureOf[kNearMean] * row.stride);
  subtractMeans(row, width, row.measures + kMeasureOf[kWideMean] * row.stride);
}

/// Of the views' disparities, at most 2 px, as a share of that; 0 without a right view.
void fillDistances(const ConfidenceRow& row, int width) {
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

void fillMeasures(const ConfidenceRow& row, int width) {
  fillPixels(row, width);
  fillWindows(row, width);
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
  static const ConfidenceKernels kernels = {fillCells, fillMeasures, apply, roughness};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
