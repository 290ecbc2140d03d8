// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/subpixel.hpp"

namespace fdp_stereo {

/// Semi-global matching (Hirschmueller, PAMI 2008) along four paths: both ways along rows and columns.
struct SemiGlobalParams {
  double p1 = 0.6;             ///< cost units: disparity changes by 1
  double p2 = 2.7;             ///< cost units: disparity changes by more
  double p2_gradient = 0.045;  ///< P2 / (1 + p2_gradient * |dI|), dI in grey levels along the path; never below p1
  SubpixelFit subpixel = SubpixelFit::kBlended;
  double uniqueness_ratio = 0.0;  ///< %, as stereo_image_proc
};

/// What the sums over the paths need beside a cost, in cost units (see cost_scale.hpp).
double penaltiesOf(const SemiGlobalParams& params);

/// Keeps its memory from pair to pair; not thread-safe.
class SemiGlobalMatcher {
 public:
  SemiGlobalMatcher();
  ~SemiGlobalMatcher();
  SemiGlobalMatcher(SemiGlobalMatcher&&) noexcept;
  SemiGlobalMatcher& operator=(SemiGlobalMatcher&&) noexcept;

  /// Disparities of both views from the costs of the left one. guide: the left image, CV_8UC1, of the volume's size.
  /// Every row_step-th row takes part, from row_step / 2 on, as if there were no others; the maps have as many rows as
  /// took part. The result is the same for every number of threads. Throws std::invalid_argument for a guide of another
  /// size or type, or costs and penalties that do not fit the depth of the volume together.
  void match(const CostVolume& volume, const cv::Mat& guide, const SemiGlobalParams& params, OptimizerOutput& output,
             int row_step = 1);

  /// Bytes beside the volume for each of its costs, with a row_step of 1.
  static constexpr double kBytesPerCost = 1.0;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace fdp_stereo
