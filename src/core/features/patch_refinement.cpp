// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "features/patch_refinement.hpp"

#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace fdp_stereo {
namespace {

constexpr int kRadius = 5;
constexpr int kSide = 2 * kRadius + 1;
constexpr int kPixels = kSide * kSide;
constexpr int kMaxIterations = 8;
constexpr float kMaxMovePx = 2.0F;
constexpr float kStopPx = 0.01F;
/// Smaller eigenvalue of the structure tensor per pixel (grey levels^2 / px^2) below which a direction has no texture.
constexpr float kMinTexture = 1.0F;

using Patch = std::array<float, kPixels>;

/// Subtracts the mean; returns the norm of what is left.
float centre(Patch& patch) {
  float sum = 0.0F;
  for (const float v : patch) sum += v;
  const float mean = sum / kPixels;
  float squares = 0.0F;
  for (float& v : patch) {
    v -= mean;
    squares += v * v;
  }
  return std::sqrt(squares);
}

/// The left patch, its gradients and the inverse of their structure tensor.
struct Template {
  Patch grey;
  Patch gradient_x;
  Patch gradient_y;
  float norm = 0.0F;
  Eigen::Matrix2f inverse;
  bool textured = false;

  Template(const cv::Mat& image, cv::Point at) {
    for (int j = 0, k = 0; j < kSide; ++j) {
      const int y = at.y + j - kRadius;
      const auto* above = image.ptr<uchar>(y - 1) + at.x - kRadius;
      const auto* row = image.ptr<uchar>(y) + at.x - kRadius;
      const auto* below = image.ptr<uchar>(y + 1) + at.x - kRadius;
      for (int i = 0; i < kSide; ++i, ++k) {
        grey[k] = row[i];
        gradient_x[k] = 0.5F * static_cast<float>(row[i + 1] - row[i - 1]);
        gradient_y[k] = 0.5F * static_cast<float>(below[i] - above[i]);
      }
    }
    norm = centre(grey);
    centre(gradient_x);  // the offset of the grey values is free
    centre(gradient_y);
    Eigen::Matrix2f tensor = Eigen::Matrix2f::Zero();
    for (int k = 0; k < kPixels; ++k) {
      tensor(0, 0) += gradient_x[k] * gradient_x[k];
      tensor(0, 1) += gradient_x[k] * gradient_y[k];
      tensor(1, 1) += gradient_y[k] * gradient_y[k];
    }
    tensor(1, 0) = tensor(0, 1);
    const float half_trace = 0.5F * tensor.trace();
    const float smaller = half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - tensor.determinant()));
    textured = smaller >= kMinTexture * kPixels;
    if (textured) inverse = tensor.inverse();
  }
};

/// Bilinear samples around `at`; false where they leave the image.
bool samplePatch(const cv::Mat& image, cv::Point2f at, Patch& patch) {
  const int x = static_cast<int>(std::floor(at.x));
  const int y = static_cast<int>(std::floor(at.y));
  if (x < kRadius || y < kRadius || x + kRadius + 1 >= image.cols || y + kRadius + 1 >= image.rows) return false;
  const float fx = at.x - static_cast<float>(x);
  const float fy = at.y - static_cast<float>(y);
  const float w00 = (1.0F - fx) * (1.0F - fy);
  const float w01 = fx * (1.0F - fy);
  const float w10 = (1.0F - fx) * fy;
  const float w11 = fx * fy;
  for (int j = 0, k = 0; j < kSide; ++j) {
    const auto* row = image.ptr<uchar>(y + j - kRadius) + x - kRadius;
    const auto* below = image.ptr<uchar>(y + j - kRadius + 1) + x - kRadius;
    for (int i = 0; i < kSide; ++i, ++k) {
      patch[k] = w00 * static_cast<float>(row[i]) + w01 * static_cast<float>(row[i + 1]) +
                 w10 * static_cast<float>(below[i]) + w11 * static_cast<float>(below[i + 1]);
    }
  }
  return true;
}

}  // namespace

PatchFit fitPatch(const cv::Mat& left_grey, const cv::Mat& right_grey, cv::Point left, cv::Point2f start) {
  PatchFit fit;
  fit.right = start;
  const int margin = kRadius + 1;
  if (left.x < margin || left.y < margin || left.x + margin >= left_grey.cols || left.y + margin >= left_grey.rows) {
    return fit;
  }
  const Template target(left_grey, left);
  if (!target.textured) return fit;
  Patch sample;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!samplePatch(right_grey, fit.right, sample)) return fit;
    const float norm = centre(sample);
    if (norm <= 0.0F) return fit;
    const float gain = target.norm / norm;
    Eigen::Vector2f slope = Eigen::Vector2f::Zero();
    float product = 0.0F;
    for (int k = 0; k < kPixels; ++k) {
      const float difference = gain * sample[k] - target.grey[k];
      slope(0) += target.gradient_x[k] * difference;
      slope(1) += target.gradient_y[k] * difference;
      product += sample[k] * target.grey[k];
    }
    fit.correlation = product / (norm * target.norm);
    const Eigen::Vector2f move = target.inverse * slope;
    fit.right -= cv::Point2f(move(0), move(1));
    if (std::abs(fit.right.x - start.x) > kMaxMovePx || std::abs(fit.right.y - start.y) > kMaxMovePx) return fit;
    if (move.squaredNorm() < kStopPx * kStopPx) {
      fit.converged = true;
      return fit;
    }
  }
  return fit;
}

}  // namespace fdp_stereo
