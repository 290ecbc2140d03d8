// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Core>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

enum class RowAlignmentMode { kPerFrame, kAccumulate };
enum class RowAlignmentModel { kAuto, kConstant, kAffine, kQuadratic };

/// Stage 2: vertical offset between the views from the row residuals of the matches, and its repair.
struct RowAlignmentParams {
  bool enabled = true;
  RowAlignmentMode mode = RowAlignmentMode::kPerFrame;
  RowAlignmentModel model = RowAlignmentModel::kAuto;
  double warn_px = 0.3;  ///< a larger RMS offset is reported as a calibration that is off
};

/// dv(x, y) = v_p - v_q as a polynomial in left-image coordinates; all zero = identity.
struct RowOffsetModel {
  /// 1, x, y, x^2, xy, y^2 with x, y in [-1, 1] over the image.
  Eigen::Matrix<double, 6, 1> coefficients = Eigen::Matrix<double, 6, 1>::Zero();
  int order = -1;  ///< -1 identity, 0 constant, 1 affine, 2 quadratic
  cv::Size size;
  bool identity() const { return order < 0; }
  double offsetAt(double x, double y) const;
};

/// What the stage did to one pair.
struct RowAlignment {
  RowOffsetModel model;
  int matches_used = 0;
  double rms_before_px = 0.0;   ///< robust RMS of the row residuals as given
  double rms_after_px = 0.0;    ///< and about the model
  double sigma_px = 0.0;        ///< uncertainty of the model, RMS over the image
  double offset_rms_px = 0.0;   ///< RMS of the model over the image: how far the calibration is off
  std::string note;             ///< why the identity was kept, or the model chosen
};

/// The model that the matches support; the identity when in doubt. Never throws on degenerate matches.
RowAlignment estimateRowAlignment(const FeatureMatches& matches, cv::Size size, const RowAlignmentParams& params);

/// The right image resampled so that its rows meet the left's. Returns the image itself for the identity.
/// 8U or 16U, 1 or 3 channels.
cv::Mat alignRows(const cv::Mat& right, const RowOffsetModel& model);

/// The same estimate over a stream: forgets slowly, starts anew when the evidence jumps.
class RowAlignmentAccumulator {
 public:
  RowAlignment update(const FeatureMatches& matches, cv::Size size, const RowAlignmentParams& params);
  void reset();

 private:
  // Filled by the stage's implementation.
  FeatureMatches history_;
};

}  // namespace fdp_stereo
