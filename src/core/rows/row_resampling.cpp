// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fdp_stereo/row_alignment.hpp"
#include "simd/row_resampling_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr int kPhases = 64;   // positions between two rows that have weights of their own
constexpr int kBlockPx = 16;  // columns that share one offset: it changes by a few px over a whole image
constexpr int kReach = kResamplingTaps / 2;

using Weights = std::array<std::int32_t, kResamplingTaps>;

double sinc(double t) { return t == 0.0 ? 1.0 : std::sin(CV_PI * t) / (CV_PI * t); }

/// Lanczos weights with 3 lobes per phase; their sum is exactly 1, so that a constant image stays what it is.
std::array<Weights, kPhases> makeWeights() {
  std::array<Weights, kPhases> table{};
  for (int phase = 0; phase < kPhases; ++phase) {
    std::array<double, kResamplingTaps> weight{};
    double sum = 0.0;
    for (int k = 0; k < kResamplingTaps; ++k) {
      const double t = k - (kReach - 1) - static_cast<double>(phase) / kPhases;
      weight[k] = sinc(t) * sinc(t / kReach);
      sum += weight[k];
    }
    std::int32_t rest = 1 << kResamplingBits;
    for (int k = 0; k < kResamplingTaps; ++k) {
      table[phase][k] = static_cast<std::int32_t>(std::lround(weight[k] / sum * (1 << kResamplingBits)));
      rest -= table[phase][k];
    }
    table[phase][phase < kPhases / 2 ? kReach - 1 : kReach] += rest;
  }
  return table;
}

/// Row position in the given image that column x of aligned row y comes from, in units of 1 / kPhases px.
int sourcePhase(const RowOffsetModel& model, int x, int y) { return cvRound((y - model.offsetAt(x, y)) * kPhases); }

template <typename T>
using Combine = void (*)(const T* const*, const std::int32_t*, int, T*);

/// One row of the result: runs of columns with one source position at a time.
template <typename T>
void alignRow(const cv::Mat& right, const RowOffsetModel& model, int y, Combine<T> combine, cv::Mat& aligned) {
  static const std::array<Weights, kPhases> table = makeWeights();
  const int channels = right.channels();
  for (int begin = 0, end = 0; begin < right.cols; begin = end) {
    const int position = sourcePhase(model, begin + kBlockPx / 2, y);
    do {
      end = std::min(right.cols, end + kBlockPx);
    } while (end < right.cols && sourcePhase(model, end + kBlockPx / 2, y) == position);
    const int phase = ((position % kPhases) + kPhases) % kPhases;
    const int base = (position - phase) / kPhases - (kReach - 1);
    std::array<const T*, kResamplingTaps> rows{};
    for (int k = 0; k < kResamplingTaps; ++k) {
      rows[k] = right.ptr<T>(std::clamp(base + k, 0, right.rows - 1)) + channels * begin;
    }
    combine(rows.data(), table[phase].data(), channels * (end - begin), aligned.ptr<T>(y) + channels * begin);
  }
}

template <typename T>
cv::Mat alignImage(const cv::Mat& right, const RowOffsetModel& model, Combine<T> combine) {
  cv::Mat aligned(right.size(), right.type());
#pragma omp parallel for schedule(static)
  for (int y = 0; y < right.rows; ++y) alignRow<T>(right, model, y, combine, aligned);
  return aligned;
}

}  // namespace

cv::Mat alignRows(const cv::Mat& right, const RowOffsetModel& model) {
  const bool known = right.depth() == CV_8U || right.depth() == CV_16U;
  if (!known || (right.channels() != 1 && right.channels() != 3)) {
    throw std::invalid_argument("row alignment: the image must have 8 or 16 bits without sign and 1 or 3 channels");
  }
  if (model.identity()) return right;
  if (right.size() != model.size) {
    throw std::invalid_argument("row alignment: image of " + std::to_string(right.cols) + " x " +
                                std::to_string(right.rows) + ", model of " + std::to_string(model.size.width) + " x " +
                                std::to_string(model.size.height));
  }
  const RowResamplingKernels& kernels = FDP_STEREO_SELECT(rowResamplingKernels);
  return right.depth() == CV_8U ? alignImage<std::uint8_t>(right, model, kernels.combine8)
                                : alignImage<std::uint16_t>(right, model, kernels.combine16);
}

}  // namespace fdp_stereo
