// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/subpixel.hpp"

namespace fdp_stereo {

/// Semi-global matching (Hirschmueller, PAMI 2008) on the cost volume.
struct SemiGlobalParams {
  int paths = 8;              ///< 4 or 8
  double p1 = 0.8;            ///< cost units: disparity changes by 1
  double p2 = 4.0;            ///< cost units: disparity changes by more
  double p2_gradient = 0.05;  ///< P2 / (1 + p2_gradient * |dI|), dI in grey levels along the path; never below p1
  SubpixelFit subpixel = SubpixelFit::kBlended;
  double uniqueness_ratio = 0.0;  ///< %, as stereo_image_proc
};

class SemiGlobal : public Optimizer {
 public:
  explicit SemiGlobal(const SemiGlobalParams& params);
  ~SemiGlobal() override;
  void optimize(const OptimizerInput& input, OptimizerOutput& output) override;
  /// The same over every row_step-th row, from firstRow() on, as if there were no others, along `paths` (4 or 8) paths:
  /// a rough answer for a fraction of the time. The maps have as many rows as took part.
  void optimizeRows(const OptimizerInput& input, int paths, int row_step, OptimizerOutput& output);
  static int firstRow(int height, int row_step);
  double costHeadroom() const override { return params_.p1 + params_.p2; }

 private:
  struct Workspace;
  SemiGlobalParams params_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace fdp_stereo
