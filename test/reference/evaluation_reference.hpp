// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "evaluation/evaluation.hpp"

namespace fdp_stereo {
namespace reference {

/// List of errors first (infinite where there is no answer), then one pass per figure.
inline DisparityErrors evaluateDisparity(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask) {
  std::vector<float> errors;
  double outliers = 0.0;
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      if (std::isnan(truth.at<float>(y, x))) continue;
      if (!mask.empty() && mask.at<unsigned char>(y, x) != 255) continue;
      const float d = disparity.at<float>(y, x);
      const float error = d >= 0.0F ? std::fabs(d - truth.at<float>(y, x)) : INFINITY;
      if (error > 3.0F && static_cast<double>(error) > 0.05 * static_cast<double>(truth.at<float>(y, x)))
        outliers += 1.0;
      errors.push_back(error);
    }
  }
  const double n = static_cast<double>(errors.size());
  DisparityErrors result;
  result.d1 = 100.0 * outliers / n;
  for (std::size_t t = 0; t < result.bad.size(); ++t) {
    const auto above = std::count_if(errors.begin(), errors.end(), [&](float e) { return e > kBadThresholdsPx[t]; });
    result.bad[t] = 100.0 * static_cast<double>(above) / n;
  }
  errors.erase(std::remove(errors.begin(), errors.end(), INFINITY), errors.end());
  const double answered = static_cast<double>(errors.size());
  result.density = 100.0 * answered / n;
  if (errors.empty()) return result;
  const auto above = std::count_if(errors.begin(), errors.end(), [](float e) { return e > 0.5F; });
  result.sparse_bad_half = 100.0 * static_cast<double>(above) / answered;
  double sum = 0.0;
  for (const float e : errors) sum += std::min(e, 100.0F);
  result.average_px = sum / answered;
  std::sort(errors.begin(), errors.end());
  std::size_t within = 0;  // pixels off by no more than the smallest errors
  while (20 * ++within < 19 * errors.size()) {
  }
  result.a95_px = std::min(errors[within - 1], 100.0F);
  return result;
}

}  // namespace reference
}  // namespace fdp_stereo
