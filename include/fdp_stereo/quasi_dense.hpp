// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/disparity_propagation.hpp"
#include "fdp_stereo/semi_global.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Seeds from a first, rough matching of the pair, and how they are spread. They lie wherever there is texture, not at
/// corners alone, so that their surfaces reach into the places that have none.
struct QuasiDenseParams {
  bool enabled = true;
  int row_step = 4;     ///< every row_step-th row is matched, >= 1
  int spacing_px = 6;   ///< from seed to seed along a row, >= 1; between rows rounded down to matched ones
  double gamma = 20.0;  ///< as DisparityPropagationParams::gamma, of the surface form
  double reach_px = 250.0;
  double strength = 0.06;
  double spread_px = 2.0;
};

/// What spreads the seeds: the surface form of stage 6.
DisparityPropagationParams surfacesOf(const QuasiDenseParams& params);

/// A first matching of every row_step-th row, CV_32FC1, NaN = none.
struct RoughDisparity {
  cv::Mat winners;  ///< as they are
  cv::Mat known;    ///< those that pass a left-right check and lie in no speckle
};

/// volume: of the image, or of these rows alone. guide and penalties are those of SemiGlobalMatcher::match(), which
/// throws.
RoughDisparity matchRoughly(const CostVolume& volume, const cv::Mat& guide, const QuasiDenseParams& params,
                            const SemiGlobalParams& penalties, SemiGlobalMatcher& matcher);

/// Known disparities become seeds, each the median of the 7 pixels of its row around it; seeds that fewer than 2 of the
/// 8 around them agree with (2 px) are left out. Sorted by (y, x), source kQuasiDense. size: of the image.
Seeds quasiDenseSeeds(const RoughDisparity& rough, cv::Size size, const QuasiDenseParams& params);

}  // namespace fdp_stereo
