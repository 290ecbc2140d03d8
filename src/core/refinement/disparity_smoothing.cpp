// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/disparity_smoothing.hpp"

#include <algorithm>
#include <cmath>

#include "arguments.hpp"
#include "parallel.hpp"
#include "simd/disparity_smoothing_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr float kFar = 1e9F;  // stands for NaN: too far from every disparity to weigh anything

/// The image with the channels of a row one after another, so that each is contiguous.
cv::Mat planarRows(const cv::Mat& image) {
  const int channels = image.channels();
  cv::Mat planar(image.rows, image.cols * channels, CV_8UC1);
#pragma omp parallel for schedule(static)
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint8_t>(y);
    auto* to = planar.ptr<std::uint8_t>(y);
    for (int c = 0; c < channels; ++c) {
      for (int x = 0; x < image.cols; ++x) to[c * image.cols + x] = from[x * channels + c];
    }
  }
  return planar;
}

/// What both directions share.
struct Smoother {
  cv::Mat image;  // planar rows
  int width, height, channels, radius;
  float inverse_difference2, inverse_gamma2;

  void add(const float* d, const float* near_d, const std::uint8_t* pixels, const std::uint8_t* near_pixels, int count,
           float* sums, float* weights) const {
    FDP_STEREO_SELECT(disparitySmoothingKernels)
        .addNeighbour(d, near_d, pixels, near_pixels, channels, width, count, inverse_difference2, inverse_gamma2, sums,
                      weights);
  }

  void addAlongRow(int y, const cv::Mat& source, float* sums, float* weights) const {
    const auto* d = source.ptr<float>(y);
    const auto* pixels = image.ptr<std::uint8_t>(y);
    for (int u = 1; u <= std::min(radius, width - 1); ++u) {
      add(d + u, d, pixels + u, pixels, width - u, sums + u, weights + u);
      add(d, d + u, pixels, pixels + u, width - u, sums, weights);
    }
  }

  void addAlongColumns(int y, const cv::Mat& source, float* sums, float* weights) const {
    for (int v = std::max(y - radius, 0); v <= std::min(y + radius, height - 1); ++v) {
      if (v == y) continue;
      add(source.ptr<float>(y), source.ptr<float>(v), image.ptr<std::uint8_t>(y), image.ptr<std::uint8_t>(v), width,
          sums, weights);
    }
  }

  void run(const cv::Mat& source, cv::Mat& target, bool along_rows) const {
    struct Scratch {
      std::vector<float> sums, weights;
    };
    const auto makeScratch = [&] { return Scratch{std::vector<float>(width), std::vector<float>(width)}; };
    parallelFor(height, makeScratch, [&](int y, Scratch& scratch) {
      std::fill(scratch.sums.begin(), scratch.sums.end(), 0.0F);
      std::fill(scratch.weights.begin(), scratch.weights.end(), 1.0F);  // the pixel itself
      if (along_rows) {
        addAlongRow(y, source, scratch.sums.data(), scratch.weights.data());
      } else {
        addAlongColumns(y, source, scratch.sums.data(), scratch.weights.data());
      }
      const auto* from = source.ptr<float>(y);
      auto* to = target.ptr<float>(y);
      for (int x = 0; x < width; ++x) to[x] = from[x] == kFar ? kFar : from[x] + scratch.sums[x] / scratch.weights[x];
    });
  }
};

}  // namespace

void smoothDisparity(cv::Mat& disparity, const cv::Mat& left, const DisparitySmoothingParams& params) {
  requireMap(disparity, "disparity smoothing");
  requireImage(left, disparity.size(), "disparity smoothing");
  if (params.radius <= 0) return;
  const auto difference = static_cast<float>(params.max_difference_px);
  const auto gamma = static_cast<float>(params.gamma * left.channels());
  const Smoother smoother{planarRows(left),      left.cols,     left.rows,
                          left.channels(),       params.radius, 1.0F / (difference * difference),
                          1.0F / (gamma * gamma)};
  const cv::Mat holes = ~(disparity == disparity);  // OpenCV finds no NaN by != where it compares vectors
  cv::Mat halfway(disparity.size(), CV_32FC1);
  disparity.setTo(kFar, holes);
  smoother.run(disparity, halfway, true);
  smoother.run(halfway, disparity, false);
  disparity.setTo(kInvalidDisparity, holes);
}

}  // namespace fdp_stereo
