// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 0: images as given to what the stages work on. 8 or 16 bit, 1 or 3 (BGR) channels, equal sizes; one may be
/// grey and the other colour, then both are made grey. 16-bit values keep their full depth in the grey images
/// (census) and are shifted right by the same number of bits in both views, so that the largest fits 8 bits, for the
/// colour terms. Never modifies its input; shares it where nothing has to change.
/// Throws std::invalid_argument naming size or type where the two cannot be matched.
StereoPair prepareImages(const cv::Mat& left, const cv::Mat& right);

}  // namespace fdp_stereo
