// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/row_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

using Basis = RowOffsetModel::Coefficients;
using BasisMatrix = Eigen::Matrix<double, kRowOffsetTerms, kRowOffsetTerms>;

/// Residual at which a match counts a quarter; matches scatter by 0.1 to 0.2 px.
constexpr double kScalePx = 0.35;
constexpr int kFolds = 5;
constexpr int kFoldCells = 12;  // matches of one of 12 x 12 cells share a fold: neighbours share their errors
/// Terms, matches needed and largest uncertainty (px, RMS over the image) of each order.
constexpr std::array<int, 4> kTerms = {1, 3, 6, 7};
constexpr std::array<int, 4> kMinMatches = {12, 30, 60, 80};
constexpr double kMaxSigmaPx = 0.1;
/// Held-out loss must fall by this many standard errors, and by this share, for an order to be taken.
constexpr double kMinStandardErrors = 2.0;
constexpr double kMinGain = 0.02;
/// Standard deviation of the positions, in units of half the image, below which nothing is known of the rest of it.
constexpr double kMinSpread = 0.1;
/// Share of the matches that must lie within kScalePx of the model: matches that are all wrong agree on nothing.
constexpr double kMinShare = 0.3;
/// A model that moves the rows by less (RMS) is not worth the resampling.
constexpr double kMinOffsetPx = 0.04;

/// Of a stream: rise of the mean loss that tells that the cameras moved, and weight below which a match is dropped.
constexpr double kJump = 0.25;
constexpr double kForgotten = 0.1;
/// Matches remembered at most: beyond these more of them cost time and tell nothing new.
constexpr std::size_t kMaxHistory = 800;

Basis basisAt(double x, double y, cv::Size size) {
  const double u = 2.0 * x / std::max(1, size.width - 1) - 1.0;
  const double v = 2.0 * y / std::max(1, size.height - 1) - 1.0;
  Basis b;
  const double aspect = static_cast<double>(size.height) / std::max(1, size.width);
  b << 1.0, u, v, u * u, u * v, v * v, v * (u * u + aspect * aspect * v * v);
  return b;
}

/// One match as the fit sees it.
struct Sample {
  Basis basis;
  double dv = 0.0;
  double weight = 1.0;
  int fold = 0;
};

/// Geman and McClure: 0 to 1, and all that is far off costs the same.
double loss(double residual) { return residual * residual / (residual * residual + kScalePx * kScalePx); }

Sample makeSample(const FeatureMatch& match, double weight, cv::Size size) {
  Sample sample;
  sample.basis = basisAt(match.right.x, match.left.y, size);
  sample.dv = match.rowResidual();
  sample.weight = weight;
  const int column = static_cast<int>(match.right.x) * kFoldCells / std::max(1, size.width);
  const int row = static_cast<int>(match.left.y) * kFoldCells / std::max(1, size.height);
  sample.fold = (column + 2 * row) % kFolds;  // no two neighbouring cells share a fold
  return sample;
}

struct Fit {
  Basis coefficients = Basis::Zero();
  BasisMatrix covariance = BasisMatrix::Zero();
  bool ok = false;
};

double medianOffset(const std::vector<Sample>& samples) {
  std::vector<double> values;
  for (const Sample& s : samples) values.push_back(s.dv);
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// One reweighted step on the samples outside `left_out`; false where they do not determine the terms.
bool reweightedStep(const std::vector<Sample>& samples, int terms, int left_out, double scale, Fit& fit) {
  BasisMatrix normal = BasisMatrix::Zero();
  Basis right_side = Basis::Zero();
  double squares = 0.0;
  double weights = 0.0;
  for (const Sample& s : samples) {
    if (s.fold == left_out) continue;
    const double residual = s.dv - s.basis.dot(fit.coefficients);
    const double root = 1.0 + residual * residual / (scale * scale);
    const double weight = s.weight / (root * root);
    normal.noalias() += weight * s.basis * s.basis.transpose();
    right_side += weight * s.dv * s.basis;
    squares += weight * residual * residual;
    weights += weight;
  }
  const Eigen::MatrixXd block = normal.topLeftCorner(terms, terms);
  const Eigen::LDLT<Eigen::MatrixXd> solver(block);
  if (weights <= 0.0 || solver.info() != Eigen::Success || solver.rcond() < 1e-6) return false;
  fit.coefficients.setZero();
  fit.coefficients.head(terms) = solver.solve(right_side.head(terms));
  fit.covariance.setZero();
  fit.covariance.topLeftCorner(terms, terms) =
      squares / weights * solver.solve(Eigen::MatrixXd::Identity(terms, terms));
  return true;
}

/// From a wide scale down to the final one, so that a steep field is found as well.
Fit fitOrder(const std::vector<Sample>& samples, int order) {
  Fit fit;
  fit.coefficients(0) = medianOffset(samples);
  for (double scale = 2.4; scale > kScalePx; scale *= 0.7) {
    if (!reweightedStep(samples, kTerms[order], -1, scale, fit)) return fit;
  }
  for (int i = 0; i < 10; ++i) {
    if (!reweightedStep(samples, kTerms[order], -1, kScalePx, fit)) return fit;
  }
  fit.ok = true;
  return fit;
}

/// Loss of each sample under the fit to the other folds.
std::vector<double> heldOutLosses(const std::vector<Sample>& samples, int order, const Fit& full) {
  std::vector<double> losses(samples.size());
  for (int fold = 0; fold < kFolds; ++fold) {
    Fit fit = full;
    for (int i = 0; i < 4; ++i) {
      if (!reweightedStep(samples, kTerms[order], fold, kScalePx, fit)) break;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (samples[i].fold == fold) losses[i] = loss(samples[i].dv - samples[i].basis.dot(fit.coefficients));
    }
  }
  return losses;
}

/// Is the mean of `better` below that of `worse` by more than chance?
bool clearlyBetter(const std::vector<Sample>& samples, const std::vector<double>& better,
                   const std::vector<double>& worse) {
  double weights = 0.0;
  double mean = 0.0;
  double mean_worse = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    weights += samples[i].weight;
    mean += samples[i].weight * (worse[i] - better[i]);
    mean_worse += samples[i].weight * worse[i];
  }
  mean /= weights;
  mean_worse /= weights;
  double variance = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double deviation = samples[i].weight * (worse[i] - better[i] - mean);
    variance += deviation * deviation;
  }
  return mean > kMinStandardErrors * std::sqrt(variance) / weights && mean > kMinGain * mean_worse;
}

/// RMS over the image of sqrt(b' M b): of the model (M = c c') or of its uncertainty (M = covariance).
double rmsOverImage(const BasisMatrix& matrix, cv::Size size) {
  constexpr int kSteps = 9;
  double sum = 0.0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const Basis b = basisAt(i * (size.width - 1.0) / (kSteps - 1), j * (size.height - 1.0) / (kSteps - 1), size);
      sum += b.dot(matrix * b);
    }
  }
  return std::sqrt(std::max(0.0, sum / (kSteps * kSteps)));
}

/// Do the matches cover more than a row, a column or a spot?
bool spreadOut(const std::vector<Sample>& samples) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const Sample& s : samples) {
    const Eigen::Vector2d p(s.basis(1), s.basis(2));
    sum += p;
    squares += p * p.transpose();
  }
  const auto n = static_cast<double>(samples.size());
  const Eigen::Matrix2d covariance = squares / n - sum / n * (sum / n).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()(0) > kMinSpread * kMinSpread;
}

double shareWithinScale(const std::vector<Sample>& samples, const Fit& fit) {
  const auto near = [&](const Sample& s) { return std::abs(s.dv - s.basis.dot(fit.coefficients)) < kScalePx; };
  return static_cast<double>(std::count_if(samples.begin(), samples.end(), near)) / static_cast<double>(samples.size());
}

struct Choice {
  int order = -1;
  Fit fit;
  double offset_rms_px = 0.0;
};

/// Climbs the orders as long as the held-out matches gain by it.
Choice chooseOrder(const std::vector<Sample>& samples, cv::Size size, const RowAlignmentParams& params) {
  Choice choice;
  std::vector<double> best;
  for (const Sample& s : samples) best.push_back(loss(s.dv));
  const bool automatic = params.model == RowAlignmentModel::kAuto;
  for (int order = 0; order < static_cast<int>(kTerms.size()); ++order) {
    if (!automatic && order != static_cast<int>(params.model) - 1) continue;
    if (static_cast<int>(samples.size()) < kMinMatches[order]) break;
    const Fit fit = fitOrder(samples, order);
    if (!fit.ok || rmsOverImage(fit.covariance, size) > kMaxSigmaPx || shareWithinScale(samples, fit) < kMinShare)
      continue;
    const std::vector<double> losses = heldOutLosses(samples, order, fit);
    if (!clearlyBetter(samples, losses, best)) continue;
    choice.order = order;
    choice.fit = fit;
    choice.offset_rms_px = rmsOverImage(fit.coefficients * fit.coefficients.transpose(), size);
    best = losses;
  }
  return choice;
}

std::string px(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.2f px", value);
  return buffer.data();
}

/// Residuals of the matches that agree with the model, before and after.
void measure(const std::vector<Sample>& samples, RowAlignment& result) {
  std::vector<double> residuals;
  for (const Sample& s : samples) residuals.push_back(std::abs(s.dv - s.basis.dot(result.model.coefficients)));
  std::vector<double> sorted = residuals;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double limit = 3.0 * std::max(1.4826 * sorted[sorted.size() / 2], 0.2 * kScalePx);
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (residuals[i] > limit) continue;
    ++result.matches_used;
    before += samples[i].dv * samples[i].dv;
    after += residuals[i] * residuals[i];
  }
  result.rms_before_px = std::sqrt(before / std::max(1, result.matches_used));
  result.rms_after_px = std::sqrt(after / std::max(1, result.matches_used));
}

/// The note and the warning of a choice, in px of the images as given.
void describe(const RowAlignmentParams& params, const Choice& choice, double given_px, RowAlignment& result) {
  const double offset_px = given_px * result.offset_rms_px;
  if (!result.model.identity()) {
    result.note = result.model.name() + (" row offset, " + px(offset_px)) + " RMS";
  } else if (choice.order >= 0) {
    result.note = "identity: the offset is only " + px(given_px * choice.offset_rms_px);
  } else {
    result.note = "identity: matches held out of the fit do not support an offset";
  }
  if (offset_px > params.warn_px) {
    result.warning = "the rows of the views are off by " + px(offset_px) + " RMS (" + result.model.name() +
                     " model; residuals of the matches " + px(given_px * result.rms_before_px) + " before and " +
                     px(given_px * result.rms_after_px) + " after the alignment): calibrate the cameras anew";
  }
}

RowAlignment estimate(const std::vector<Sample>& samples, cv::Size size, const RowAlignmentParams& params,
                      double given_px) {
  RowAlignment result;
  result.model.size = size;
  if (static_cast<int>(samples.size()) < kMinMatches[0]) {
    result.note = "identity: " + std::to_string(samples.size()) + " matches are too few";
    return result;
  }
  if (!spreadOut(samples)) {
    result.note = "identity: the matches cover too little of the image";
    return result;
  }
  const Choice choice = chooseOrder(samples, size, params);
  if (choice.order >= 0 && choice.offset_rms_px >= kMinOffsetPx) {
    result.model.order = choice.order;
    result.model.coefficients = choice.fit.coefficients;
    result.offset_rms_px = choice.offset_rms_px;
    result.sigma_px = rmsOverImage(choice.fit.covariance, size);
  }
  measure(samples, result);
  describe(params, choice, given_px, result);
  return result;
}

}  // namespace

const char* RowOffsetModel::name() const {
  static const std::array<const char*, 5> kNames = {"identity", "constant", "affine", "quadratic", "radial"};
  return kNames.at(order + 1);
}

double RowOffsetModel::offsetAt(double x, double y) const {
  return identity() ? 0.0 : basisAt(x, y, size).dot(coefficients);
}

RowAlignment estimateRowAlignment(const FeatureMatches& matches, cv::Size size, const RowAlignmentParams& params,
                                  double given_px) {
  std::vector<Sample> samples;
  for (const FeatureMatch& m : matches) samples.push_back(makeSample(m, 1.0, size));
  return estimate(samples, size, params, given_px);
}

/// Would most of the matches, were the last model true, lie where they do?
bool RowAlignmentAccumulator::contradicts(const FeatureMatches& matches) const {
  if (static_cast<int>(matches.size()) < kMinMatches[0] || history_.empty()) return false;
  const auto meanLoss = [&](const auto& list, const auto& matchOf) {
    double sum = 0.0;
    for (const auto& entry : list) {
      const FeatureMatch& m = matchOf(entry);
      sum += loss(m.rowResidual() - last_.offsetAt(m.right.x, m.left.y));
    }
    return sum / static_cast<double>(list.size());
  };
  const double now = meanLoss(matches, [](const FeatureMatch& m) -> const FeatureMatch& { return m; });
  const double before = meanLoss(history_, [](const Aged& a) -> const FeatureMatch& { return a.match; });
  return now > before + kJump;
}

RowAlignment RowAlignmentAccumulator::update(const FeatureMatches& matches, cv::Size size,
                                             const RowAlignmentParams& params, double given_px) {
  if (params.mode == RowAlignmentMode::kPerFrame || size != last_.size || contradicts(matches)) history_.clear();
  for (Aged& aged : history_) aged.weight *= params.forgetting;
  history_.erase(std::remove_if(history_.begin(), history_.end(), [](const Aged& a) { return a.weight < kForgotten; }),
                 history_.end());
  for (const FeatureMatch& m : matches) history_.push_back({m, 1.0});
  if (history_.size() > std::max(kMaxHistory, matches.size())) {
    history_.erase(history_.begin(), history_.end() - std::max(kMaxHistory, matches.size()));
  }
  std::vector<Sample> samples;
  for (const Aged& aged : history_) samples.push_back(makeSample(aged.match, aged.weight, size));
  RowAlignment result = estimate(samples, size, params, given_px);
  last_ = result.model;
  return result;
}

void RowAlignmentAccumulator::reset() {
  history_.clear();
  last_ = RowOffsetModel();
}

FeatureMatches alignMatches(const FeatureMatches& matches, const RowOffsetModel& model) {
  FeatureMatches aligned = matches;
  for (FeatureMatch& m : aligned) m.right.y += static_cast<float>(model.offsetAt(m.right.x, m.left.y));
  return aligned;
}

}  // namespace fdp_stereo
