// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/smoothness.hpp"

#include <algorithm>
#include <cmath>

#include "images/colour.hpp"

namespace fdp_stereo::local_expansion {
namespace {

const std::array<cv::Point, kPairDirections> kSteps = {cv::Point(1, 0), cv::Point(1, 1), cv::Point(0, 1),
                                                       cv::Point(-1, 1)};

int colourThirds(const cv::Mat& image, cv::Point p, cv::Point q) {
  const int channels = image.channels();
  return fdp_stereo::colourThirds(image.ptr<std::uint8_t>(p.y) + p.x * channels,
                                  image.ptr<std::uint8_t>(q.y) + q.x * channels, channels);
}

bool inside(cv::Size size, cv::Point p) { return p.x >= 0 && p.y >= 0 && p.x < size.width && p.y < size.height; }

}  // namespace

Smoothness::Smoothness(const cv::Mat& image, const SmoothnessParams& params)
    : size_(image.size()), tau_(static_cast<float>(params.tau_px)) {
  std::array<float, kThirds> table{};
  const auto weights = colourWeights(params.gamma);
  std::transform(weights.begin(), weights.end(), table.begin(),
                 [&](double w) { return static_cast<float>(params.lambda * std::max(params.epsilon, w)); });
  for (int d = 0; d < kPairDirections; ++d) {
    weights_[d].assign(image.total(), 0.0F);
    for (int y = 0; y < size_.height; ++y) {
      for (int x = 0; x < size_.width; ++x) {
        const cv::Point p(x, y);
        const cv::Point q = p + kSteps[d];
        if (!inside(size_, q)) continue;
        weights_[d][static_cast<std::size_t>(y) * size_.width + x] = table[colourThirds(image, p, q)];
      }
    }
  }
}

double Smoothness::energy(const Labels& labels) const {
  std::vector<double> rows(size_.height, 0.0);
#pragma omp parallel for schedule(static)
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      const Plane f = labels.plane(x, y);
      for (int d = 0; d < kPairDirections; ++d) {
        const cv::Point q = cv::Point(x, y) + kSteps[d];
        if (!inside(size_, q)) continue;
        const Plane g = labels.plane(q.x, q.y);
        const Plane h = {f.a - g.a, f.b - g.b, f.c - g.c};
        const double psi = std::fabs(static_cast<double>(h.at(x, y))) + std::fabs(static_cast<double>(h.at(q.x, q.y)));
        rows[y] += static_cast<double>(weight(d, x, y)) * std::min(psi, static_cast<double>(tau_));
      }
    }
  }
  double sum = 0.0;
  for (const double row : rows) sum += row;
  return sum;
}

double energyOf(const Labels& labels, const Smoothness& smoothness) {
  double sum = 0.0;
  for (const float cost : labels.cost) sum += static_cast<double>(cost);
  return sum + smoothness.energy(labels);
}

}  // namespace fdp_stereo::local_expansion
