// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "costs/subpixel_volume.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

// result(x) = image(x - shift).
cv::Mat shifted(const cv::Mat& image, double shift) {
  const cv::Mat transform = (cv::Mat_<double>(2, 3) << 1.0, 0.0, -shift, 0.0, 1.0, 0.0);
  cv::Mat result;
  cv::warpAffine(image, result, transform, image.size(), cv::INTER_LANCZOS4 | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return result;
}

// Copies the costs of whole disparities to every steps-th entry, from `first` on.
void interleave(const CostVolume& whole, int steps, int first, CostVolume& volume) {
  const int count = whole.range().count;
#pragma omp parallel for schedule(static)
  for (int y = 0; y < whole.height(); ++y) {
    for (int x = 0; x < whole.width(); ++x) {
      const std::uint8_t* from = whole.at<std::uint8_t>(y, x);
      std::uint8_t* to = volume.at<std::uint8_t>(y, x) + first;
      for (int i = 0; i < count; ++i) to[static_cast<std::ptrdiff_t>(i) * steps] = from[i];
    }
  }
}

template <typename T>
void mirrorCosts(const CostVolume& left, CostVolume& mirrored) {
  const int width = left.width();
  const DisparityRange range = left.range();
#pragma omp parallel for schedule(static)
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < width; ++x) {  // of the right view
      T* out = mirrored.at<T>(y, width - 1 - x);
      for (int i = 0; i < range.count; ++i) {
        // Nearest i whose left pixel x + min + i is in the image.
        const int inside = std::clamp(x + range.min + i, 0, width - 1) - x - range.min;
        const int nearest = std::clamp(inside, 0, range.count - 1);
        out[i] = left.at<T>(y, std::clamp(x + range.min + nearest, 0, width - 1))[nearest];
      }
    }
  }
}

}  // namespace

void computeSubpixelVolume(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params, int steps,
                           CostVolume& volume) {
  constexpr float kLargestRaw = 252.0F;
  const CostScale scale{CostVolume::Depth::kU8, static_cast<float>(maxMatchingCost(params)) / kLargestRaw};
  const DisparityRange entries{0, (range.count - 1) * steps + 1};
  volume.create(pair.left.rows, pair.left.cols, entries, scale.depth, scale.step, static_cast<int>(kLargestRaw));
  volume.clearPadding();
  CostVolume whole;
  for (int k = 0; k < steps; ++k) {
    StereoPair moved = pair;
    const DisparityRange part{range.min, range.count - (k > 0 ? 1 : 0)};
    if (part.count == 0) break;
    if (k > 0) {
      const double shift = static_cast<double>(k) / steps;
      moved.right = shifted(pair.right, shift);
      moved.right_grey = shifted(pair.right_grey, shift);
    }
    computeMatchingCost(moved, part, params, scale, whole);
    interleave(whole, steps, k, volume);
  }
}

void mirrorVolume(const CostVolume& left, CostVolume& mirrored) {
  mirrored.create(left.height(), left.width(), left.range(), left.depth(), left.step(), left.maxRaw());
  mirrored.clearPadding();
  if (left.depth() == CostVolume::Depth::kU8) {
    mirrorCosts<std::uint8_t>(left, mirrored);
  } else {
    mirrorCosts<std::uint16_t>(left, mirrored);
  }
}

cv::Mat mirrored(const cv::Mat& image) {
  cv::Mat result;
  cv::flip(image, result, 1);
  return result;
}

StereoPair mirrorPair(const StereoPair& pair) {
  StereoPair result;
  result.left = mirrored(pair.right);
  result.right = mirrored(pair.left);
  result.left_grey = mirrored(pair.right_grey);
  result.right_grey = mirrored(pair.left_grey);
  return result;
}

Seeds mirrorSeeds(Seeds seeds, int width) {
  for (Seed& seed : seeds) seed.x = static_cast<float>(width - 1) - (seed.x - seed.d);
  return seeds;
}

}  // namespace fdp_stereo
