// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/matching_cost.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Matching costs at fractions of a pixel: entry i of a pixel is the cost of disparity range.min + i / steps, up to
/// range.max(). Between integers the right image is resampled (Lanczos) before colours, gradients and census codes are
/// taken. 8 bits per cost. steps >= 1.
void computeSubpixelVolume(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params, int steps,
                           CostVolume& volume);

/// The volume of the right view, mirrored left to right (x' = width - 1 - x), from that of the left view: the cost of
/// right pixel x at disparity d is that of left pixel x + d; where this leaves the image the nearest valid d counts.
void mirrorVolume(const CostVolume& left, CostVolume& mirrored);

/// The image mirrored left to right.
cv::Mat mirrored(const cv::Mat& image);
/// The pair seen from behind: left and right mirrored and exchanged. Its left view is the right view of `pair`, and
/// disparities keep their sign.
StereoPair mirrorPair(const StereoPair& pair);
/// The seeds in such a pair of that width.
Seeds mirrorSeeds(Seeds seeds, int width);

}  // namespace fdp_stereo
