// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/disparity_propagation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "arguments.hpp"
#include "images/colour.hpp"
#include "seeds/surface_propagation.hpp"

namespace fdp_stereo {
namespace {

/// A seed on the pixel grid of image and volume.
struct GridSeed {
  int x, y, index;
  int order;  ///< among the seeds as given
};

/// Rounded seeds inside image and range, in raster order: the products of eq. (11) commute but for their rounding.
std::vector<GridSeed> onGrid(const Seeds& seeds, DisparityAxis axis, const CostVolume& volume) {
  std::vector<GridSeed> grid;
  for (const Seed& seed : seeds) {
    const float index = (seed.d - static_cast<float>(axis.min)) * static_cast<float>(axis.steps);
    const GridSeed g{cvRound(seed.x), cvRound(seed.y), static_cast<int>(std::lround(index)),
                     static_cast<int>(grid.size())};
    const bool inside = g.x >= 0 && g.y >= 0 && g.x < volume.width() && g.y < volume.height();
    if (inside && g.index >= 0 && g.index < volume.range().count) grid.push_back(g);
  }
  std::sort(grid.begin(), grid.end(), [](const GridSeed& a, const GridSeed& b) {
    return std::tie(a.y, a.x, a.order) < std::tie(b.y, b.x, b.order);
  });
  return grid;
}

/// 2^16 (1 - w) of eq. (11) by colourThirds().
std::array<std::uint32_t, kThirds> makeFactors(double gamma) {
  const auto weights = colourWeights(gamma);
  std::array<std::uint32_t, kThirds> factors{};
  std::transform(weights.begin(), weights.end(), factors.begin(),
                 [](double w) { return static_cast<std::uint32_t>(std::lround(65536.0 * (1.0 - w))); });
  return factors;
}

/// Algorithm 1 with rounded disparities.
template <typename T>
double propagateWindows(const std::vector<GridSeed>& seeds, const cv::Mat& left,
                        const DisparityPropagationParams& params, CostVolume& volume) {
  const auto factors = makeFactors(params.gamma);
  const int radius = params.window / 2;
  const int channels = left.channels();
  std::vector<std::uint8_t> touched(left.total(), 0);
  for (const GridSeed& seed : seeds) {
    const uchar* centre = left.ptr<uchar>(seed.y) + channels * seed.x;
    for (int y = std::max(0, seed.y - radius); y <= std::min(left.rows - 1, seed.y + radius); ++y) {
      for (int x = std::max(0, seed.x - radius); x <= std::min(left.cols - 1, seed.x + radius); ++x) {
        const std::uint32_t factor = factors[colourThirds(centre, left.ptr<uchar>(y) + channels * x, channels)];
        const SearchTiles::Span span = volume.span(y, x);
        if (seed.index < span.first || seed.index >= span.first + span.count) continue;
        T& raw = volume.at<T>(y, x)[seed.index - span.first];
        raw = static_cast<T>((raw * factor + 32768U) >> 16U);
        touched[static_cast<std::size_t>(y) * left.cols + x] = 1;
      }
    }
  }
  return static_cast<double>(std::count(touched.begin(), touched.end(), 1)) / static_cast<double>(left.total());
}

void check(const cv::Mat& left, const DisparityPropagationParams& params, const CostVolume& volume) {
  if (left.rows != volume.height() || left.cols != volume.width() || left.depth() != CV_8U ||
      (left.channels() != 1 && left.channels() != 3)) {
    throw std::invalid_argument(
        "disparity propagation: the left image must be 8-bit with 1 or 3 channels and as large "
        "as the cost volume");
  }
  if (params.window < 1 || params.window % 2 == 0) {
    throw std::invalid_argument("disparity propagation: window " + std::to_string(params.window) +
                                " must be odd and >= 1");
  }
  if (!(params.gamma > 0.0) || !(params.reach_px > 0.0) || !(params.spread_px > 0.0)) {
    throw std::invalid_argument("disparity propagation: gamma " + std::to_string(params.gamma) + ", reach_px " +
                                std::to_string(params.reach_px) + " and spread_px " + std::to_string(params.spread_px) +
                                " must be > 0");
  }
}

}  // namespace

double propagateDisparity(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                          CostVolume& volume) {
  return propagateDisparity(seeds, left, params, {volume.range().min, 1}, volume);
}

double propagateDisparity(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                          DisparityAxis axis, CostVolume& volume) {
  check(left, params, volume);
  const Seeds finite = finiteSeeds(seeds);
  if (finite.empty()) return 0.0;
  if (params.form == PropagationForm::kSurface) return propagateSurfaces(finite, left, params, axis, volume);
  const std::vector<GridSeed> grid = onGrid(finite, axis, volume);
  return volume.depth() == CostVolume::Depth::kU8 ? propagateWindows<std::uint8_t>(grid, left, params, volume)
                                                  : propagateWindows<std::uint16_t>(grid, left, params, volume);
}

}  // namespace fdp_stereo
