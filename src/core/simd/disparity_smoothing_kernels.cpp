// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/disparity_smoothing_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <int kChannels>
void addNeighbourOf(const float* __restrict d, const float* __restrict near_d, const std::uint8_t* __restrict image,
                    const std::uint8_t* __restrict near_image, int channel_stride, int count, float inverse_difference2,
                    float inverse_gamma2, float* __restrict sums, float* __restrict weights) {
#pragma omp simd
  for (int x = 0; x < count; ++x) {
    int sum = 0;
    for (int c = 0; c < kChannels; ++c) {
      const int difference = near_image[c * channel_stride + x] - image[c * channel_stride + x];
      sum += difference < 0 ? -difference : difference;
    }
    const auto distance = static_cast<float>(sum);
    const float e = near_d[x] - d[x];
    const float closeness = 1.0F - e * e * inverse_difference2;
    const float w = (closeness > 0.0F ? closeness : 0.0F) / (1.0F + distance * distance * inverse_gamma2);
    sums[x] += w > 0.0F ? w * e : 0.0F;
    weights[x] += w;
  }
}

void addNeighbour(const float* d, const float* near_d, const std::uint8_t* image, const std::uint8_t* near_image,
                  int channels, int channel_stride, int count, float inverse_difference2, float inverse_gamma2,
                  float* sums, float* weights) {
  if (channels == 1) {
    addNeighbourOf<1>(d, near_d, image, near_image, channel_stride, count, inverse_difference2, inverse_gamma2, sums,
                      weights);
  } else {
    addNeighbourOf<3>(d, near_d, image, near_image, channel_stride, count, inverse_difference2, inverse_gamma2, sums,
                      weights);
  }
}

}  // namespace

const DisparitySmoothingKernels& disparitySmoothingKernels() {
  static const DisparitySmoothingKernels kernels = {addNeighbour};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
