// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <Eigen/Dense>
#include <opencv2/core.hpp>

#include "fdp_stereo/cost_volume.hpp"

/// The LocalExp energy written out in double, window by window and pair by pair, from the published formulas.
namespace fdp_stereo::reference {

struct ReferencePlane {
  double a, b, c;
  double at(double x, double y) const { return a * x + b * y + c; }
};

/// Matching cost of pixel (x, y) under a plane: linear between the stored entries, the ends beyond them, cut off.
inline double rawPlaneCost(const CostVolume& volume, int entries, double first, double per_px, double scale,
                           double threshold, const ReferencePlane& f, int x, int y) {
  const double position = std::clamp((f.at(x, y) - first) * per_px, 0.0, static_cast<double>(entries - 1));
  const int low = std::min(static_cast<int>(position), std::max(entries - 2, 0));
  const int high = std::min(low + 1, entries - 1);
  const double t = position - low;
  const double raw = (1.0 - t) * volume.raw(y, x, low) + t * volume.raw(y, x, high);
  return std::min(raw * volume.step() * scale, threshold);
}

inline Eigen::Vector3d guideColour(const cv::Mat& image, int x, int y) {
  if (image.channels() == 1) return {image.at<std::uint8_t>(y, x) / 255.0, 0.0, 0.0};
  const cv::Vec3b& c = image.at<cv::Vec3b>(y, x);
  return {c[0] / 255.0, c[1] / 255.0, c[2] / 255.0};
}

/// Guided filter of a whole image of values, as published: local linear models over clipped box windows, averaged.
inline std::vector<double> guidedFilter(const cv::Mat& guide, const std::vector<double>& values, int radius,
                                        double epsilon) {
  const int width = guide.cols;
  const int height = guide.rows;
  const auto window = [&](int x, int y) {
    return cv::Rect(x - radius, y - radius, 2 * radius + 1, 2 * radius + 1) & cv::Rect(0, 0, width, height);
  };
  std::vector<Eigen::Vector3d> slopes(values.size());
  std::vector<double> offsets(values.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const cv::Rect w = window(x, y);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      Eigen::Vector3d product = Eigen::Vector3d::Zero();
      Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
      double mean_value = 0.0;
      for (int v = w.y; v < w.y + w.height; ++v) {
        for (int u = w.x; u < w.x + w.width; ++u) {
          const Eigen::Vector3d colour = guideColour(guide, u, v);
          mean += colour;
          square += colour * colour.transpose();
          product += colour * values[v * width + u];
          mean_value += values[v * width + u];
        }
      }
      const double n = w.area();
      mean /= n;
      mean_value /= n;
      const Eigen::Matrix3d covariance = square / n - mean * mean.transpose() + epsilon * Eigen::Matrix3d::Identity();
      slopes[y * width + x] = covariance.inverse() * (product / n - mean_value * mean);
      offsets[y * width + x] = mean_value - slopes[y * width + x].dot(mean);
    }
  }
  std::vector<double> result(values.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const cv::Rect w = window(x, y);
      Eigen::Vector3d slope = Eigen::Vector3d::Zero();
      double offset = 0.0;
      for (int v = w.y; v < w.y + w.height; ++v) {
        for (int u = w.x; u < w.x + w.width; ++u) {
          slope += slopes[v * width + u];
          offset += offsets[v * width + u];
        }
      }
      result[y * width + x] = (slope.dot(guideColour(guide, x, y)) + offset) / w.area();
    }
  }
  return result;
}

/// lambda * w_pq * min(psi_pq, tau) for one pair of neighbours.
inline double pairCost(const cv::Mat& image, cv::Point p, cv::Point q, const ReferencePlane& f, const ReferencePlane& g,
                       double lambda, double tau, double gamma, double epsilon) {
  double difference = 0.0;
  for (int c = 0; c < 3; ++c) {
    const int channel = image.channels() == 3 ? c : 0;
    const int at_p = image.ptr<std::uint8_t>(p.y)[p.x * image.channels() + channel];
    const int at_q = image.ptr<std::uint8_t>(q.y)[q.x * image.channels() + channel];
    difference += std::abs(at_p - at_q);
  }
  const double psi = std::fabs(f.at(p.x, p.y) - g.at(p.x, p.y)) + std::fabs(f.at(q.x, q.y) - g.at(q.x, q.y));
  return lambda * std::max(epsilon, std::exp(-difference / 3.0 / gamma)) * std::min(psi, tau);
}

}  // namespace fdp_stereo::reference
