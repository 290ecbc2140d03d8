// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// kPerFrame: each pair by itself. kAccumulate: the matches of recent frames count too, the older the less.
enum class RowAlignmentMode { kPerFrame, kAccumulate };
/// kAuto: the smallest order that matches held out of the fit support; the others: that order or the identity.
/// kRadial adds what remains of a lens' radial distortion to the quadratic.
enum class RowAlignmentModel { kAuto, kConstant, kAffine, kQuadratic, kRadial };

/// Stage 2: vertical offset between the views from the row residuals of the matches, and its repair.
struct RowAlignmentParams {
  bool enabled = true;
  RowAlignmentMode mode = RowAlignmentMode::kPerFrame;
  RowAlignmentModel model = RowAlignmentModel::kAuto;
  double forgetting = 0.8;  ///< kAccumulate: weight of a match falls to this share per frame, 0..1
  double warn_px = 0.3;     ///< a larger RMS offset is reported as a calibration that is off
};

constexpr int kRowOffsetTerms = 7;

/// dv = v_p - v_q as a polynomial over the aligned right image: x its column, y its row (that of the left image).
struct RowOffsetModel {
  using Coefficients = Eigen::Matrix<double, kRowOffsetTerms, 1>;
  /// 1, x, y, x^2, xy, y^2, y (x^2 + (height / width)^2 y^2) with x, y in [-1, 1] over the image.
  Coefficients coefficients = Coefficients::Zero();
  int order = -1;  ///< -1 identity, 0 constant, 1 affine, 2 quadratic, 3 quadratic and radial
  cv::Size size;
  bool identity() const { return order < 0; }
  /// "identity", "constant", "affine", "quadratic" or "radial".
  const char* name() const;
  /// px; x, y in px of the aligned right image.
  double offsetAt(double x, double y) const;
};

/// What the stage did to one pair.
struct RowAlignment {
  RowOffsetModel model;
  int matches_used = 0;        ///< whose residual about the model is below three times its scatter
  double rms_before_px = 0.0;  ///< of the row residuals of these matches as given
  double rms_after_px = 0.0;   ///< and about the model
  double sigma_px = 0.0;       ///< uncertainty of the model, RMS over the image
  double offset_rms_px = 0.0;  ///< RMS of the model over the image: how far the calibration is off
  std::string note;            ///< the model chosen, or why the identity was kept
  std::string warning;         ///< what is wrong with the calibration and what to do; empty where nothing is
};

/// The model that the matches support; the identity when in doubt. Never throws on degenerate matches.
///
/// Fits by iteratively reweighted least squares (Geman-McClure weight, from a wide scale down to 0.35 px). An order is
/// taken only if matches held out of the fit (five spatial folds) support it significantly, and if there are enough of
/// them, spread over the image.
///
/// given_px: px of the images as given per px of the matches, where these are of smaller images; note, warning and
/// warn_px speak of the images as given.
RowAlignment estimateRowAlignment(const FeatureMatches& matches, cv::Size size, const RowAlignmentParams& params,
                                  double given_px = 1.0);

/// The right image resampled so that its rows meet the left's. Returns the image itself for the identity.
/// 8U or 16U, 1 or 3 channels, of the model's size; std::invalid_argument otherwise. Borders are replicated.
cv::Mat alignRows(const cv::Mat& right, const RowOffsetModel& model);

/// The matches as they are between the left image and the aligned right one.
FeatureMatches alignMatches(const FeatureMatches& matches, const RowOffsetModel& model);

/// The offset field as colour over the dimmed left image (red: the right view lies too high by up to full_scale_px,
/// blue: too low) and for each match an arrow of its row residual about the model, 40 times enlarged. CV_8UC3. left: 8U
/// or 16U, 1 or 3 channels.
cv::Mat drawRowAlignment(const cv::Mat& left, const FeatureMatches& matches, const RowAlignment& alignment,
                         double full_scale_px = 1.0);

/// The same estimate over a stream: forgets slowly, starts anew when the evidence jumps. The same sequence of matches
/// gives the same result.
class RowAlignmentAccumulator {
 public:
  /// Takes the matches of the next frame (as given, not aligned). kPerFrame: looks at this frame alone.
  RowAlignment update(const FeatureMatches& matches, cv::Size size, const RowAlignmentParams& params,
                      double given_px = 1.0);
  void reset();

 private:
  struct Aged {
    FeatureMatch match;
    double weight = 1.0;
  };
  bool contradicts(const FeatureMatches& matches) const;
  std::vector<Aged> history_;
  RowOffsetModel last_;
};

}  // namespace fdp_stereo
