// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/row_alignment.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Between a pair as given ("full") and the smaller one that is matched in its place ("small"). Pixel centres are at
/// integers in both.
class Scaling {
 public:
  /// scale: of the sides, 0 < scale <= 1; each side of the small pair keeps at least one pixel.
  Scaling(cv::Size full, double scale);
  bool identity() const { return full_ == small_; }

  /// Area means of the images; the pair itself for the identity.
  StereoPair shrink(const StereoPair& pair) const;
  /// Covers all of the full range.
  DisparityRange shrink(DisparityRange range) const;
  Seeds shrink(Seeds seeds) const;

  Seeds grow(Seeds seeds) const;
  FeatureMatches grow(FeatureMatches matches) const;
  /// The same offsets in px of the full image.
  RowAlignment grow(RowAlignment alignment) const;
  /// Full-size disparity (CV_32FC1 px, NaN = none) of a small one. Each pixel joins the surface of the small pixel
  /// around it that is nearest in place and colour, and interpolates between those that lie on it (within 1 px), so
  /// that planes stay planes and edges follow the full image. Clamped to `range`. left_small, left_full: CV_8UC1 or
  /// CV_8UC3.
  cv::Mat grow(const cv::Mat& disparity, const cv::Mat& left_small, const cv::Mat& left_full,
               DisparityRange range) const;

 private:
  cv::Size full_, small_;
  double x_, y_;  ///< small px per full px
};

}  // namespace fdp_stereo
