// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// The values of 16-bit images that become black and white in 8 bits; none before the first pair.
struct ValueRange {
  int black = 0;
  int white = 0;
};

/// Stage 0: images as given to what the stages work on. 8 or 16 bit, 1 or 3 (BGR) channels, equal sizes; one may be
/// grey and the other colour, then both are made grey. 16-bit values keep their full depth in the grey images (census);
/// for the colour terms they are brought to 8 bits, in both views and all channels alike: from the darkest to the
/// brightest value but for half a percent each (hot pixels, lamps) and for 0 (borders of rectification); differences
/// are never enlarged. Never modifies its input; shares it where nothing has to change.
/// range: that of the pair before, kept as long as it fits nearly as well, so that nothing flickers; else a new one.
/// Throws std::invalid_argument naming size or type where the two cannot be matched.
StereoPair prepareImages(const cv::Mat& left, const cv::Mat& right, ValueRange& range);
StereoPair prepareImages(const cv::Mat& left, const cv::Mat& right);

/// An image of 8 or 16 bits in 8 bits, as prepareImages() makes it; for display.
cv::Mat toEightBit(const cv::Mat& image);

}  // namespace fdp_stereo
