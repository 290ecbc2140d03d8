// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/matching_cost_kernels.hpp"

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

template <int kPlanes>
void absoluteDifferencesOf(const std::int16_t* __restrict left, const std::int16_t* __restrict right, int plane_stride,
                           int count, std::uint16_t limit, std::uint16_t* __restrict sums) {
  for (int i = 0; i < count; ++i) {
    std::uint16_t sum = 0;
    for (int c = 0; c < kPlanes; ++c) {
      const std::int16_t a = left[c];
      const std::int16_t b = right[c * plane_stride + i];
      sum = static_cast<std::uint16_t>(sum + (a > b ? a - b : b - a));
    }
    sums[i] = sum < limit ? sum : limit;
  }
}

void absoluteDifferences(const std::int16_t* left, const std::int16_t* right, int planes, int plane_stride, int count,
                         std::uint16_t limit, std::uint16_t* sums) {
  switch (planes) {
    case 1:
      return absoluteDifferencesOf<1>(left, right, plane_stride, count, limit, sums);
    case 2:
      return absoluteDifferencesOf<2>(left, right, plane_stride, count, limit, sums);
    case 3:
      return absoluteDifferencesOf<3>(left, right, plane_stride, count, limit, sums);
    default:
      return absoluteDifferencesOf<5>(left, right, plane_stride, count, limit, sums);
  }
}

void birchfieldTomasi(const std::int16_t* __restrict left, const std::int16_t* __restrict right, int plane_stride,
                      int count, std::uint16_t limit, std::uint16_t* __restrict sums) {
  const std::int16_t* __restrict value = right;
  const std::int16_t* __restrict smallest = right + plane_stride;
  const std::int16_t* __restrict largest = right + 2 * plane_stride;
  for (int i = 0; i < count; ++i) {
    const int to_right = left[0] > largest[i]    ? left[0] - largest[i]
                         : smallest[i] > left[0] ? smallest[i] - left[0]
                                                 : 0;
    const int to_left = value[i] > left[2] ? value[i] - left[2] : left[1] > value[i] ? left[1] - value[i] : 0;
    const int cost = to_right < to_left ? to_right : to_left;
    sums[i] = static_cast<std::uint16_t>(cost < limit ? cost : limit);
  }
}

void hamming(std::uint64_t left, const std::uint64_t* __restrict right, int count, std::uint16_t weight, bool first,
             std::uint16_t* __restrict sums) {
  if (first) {
    for (int i = 0; i < count; ++i) {
      sums[i] = static_cast<std::uint16_t>(weight * __builtin_popcountll(left ^ right[i]));
    }
  } else {
    for (int i = 0; i < count; ++i) {
      sums[i] = static_cast<std::uint16_t>(sums[i] + weight * __builtin_popcountll(left ^ right[i]));
    }
  }
}

template <typename T>
void combine(const std::uint16_t* __restrict a, const std::uint16_t* __restrict table_a,
             const std::uint16_t* __restrict b, const std::uint16_t* __restrict table_b, int count, int shift,
             T* __restrict costs) {
  const std::uint32_t half = (1U << shift) >> 1;
  for (int i = 0; i < count; ++i) {
    costs[i] = static_cast<T>((static_cast<std::uint32_t>(table_a[a[i]]) + table_b[b[i]] + half) >> shift);
  }
}

}  // namespace

const MatchingCostKernels& matchingCostKernels() {
  static const MatchingCostKernels kernels = {absoluteDifferences, birchfieldTomasi, hamming, combine<std::uint8_t>,
                                              combine<std::uint16_t>};
  return kernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
