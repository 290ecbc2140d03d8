// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

namespace fdp_stereo {
namespace {

constexpr float kRedErrorPx = 4.0F;
constexpr double kQuantile = 0.95;
const cv::Vec3b kNoAnswerColor(255, 0, 255);

void checkMaps(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask) {
  if (disparity.type() != CV_32FC1 || truth.type() != CV_32FC1 || (!mask.empty() && mask.type() != CV_8UC1)) {
    throw std::invalid_argument("disparity and truth must be CV_32FC1, the mask CV_8UC1");
  }
  const auto text = [](cv::Size size) { return std::to_string(size.width) + " x " + std::to_string(size.height); };
  if (disparity.size() != truth.size() || (!mask.empty() && mask.size() != truth.size())) {
    throw std::invalid_argument("sizes differ: disparity " + text(disparity.size()) + ", truth " + text(truth.size()) +
                                (mask.empty() ? "" : ", mask " + text(mask.size())));
  }
}

bool answered(float disparity) { return std::isfinite(disparity) && disparity >= 0.0F; }

bool scored(const cv::Mat& mask, int y, int x) { return mask.empty() || mask.at<std::uint8_t>(y, x) == 255; }

/// Sums over pixels, from which the shares follow.
struct Tally {
  std::int64_t pixels = 0;
  std::array<std::int64_t, kBadThresholdsPx.size()> above{};  // among the answers
  std::int64_t outliers = 0;                                  // of D1, likewise
  std::vector<float> errors_px;                               // of the answers

  void add(float disparity, float truth) {
    ++pixels;
    if (!answered(disparity)) return;
    const float error = std::abs(disparity - truth);
    for (std::size_t i = 0; i < above.size(); ++i) above[i] += error > static_cast<float>(kBadThresholdsPx[i]) ? 1 : 0;
    outliers += error > static_cast<float>(kBadThresholdsPx.back()) && error > kOutlierShare * truth ? 1 : 0;
    errors_px.push_back(std::min(error, static_cast<float>(kMaxErrorPx)));
  }
};

double meanOf(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The smallest of the values that kQuantile of them do not exceed.
double quantileOf(std::vector<float> values) {
  const double count = std::ceil(kQuantile * static_cast<double>(values.size()));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(count) - 1;
  std::nth_element(values.begin(), place, values.end());
  return static_cast<double>(*place);
}

cv::Vec3b errorColor(float error_px) {
  const float t = std::min(error_px, kRedErrorPx);
  const float toward = t <= 1.0F ? t : (t - 1.0F) / (kRedErrorPx - 1.0F);
  const cv::Vec3f from = t <= 1.0F ? cv::Vec3f(160, 60, 20) : cv::Vec3f(245, 245, 245);
  const cv::Vec3f to = t <= 1.0F ? cv::Vec3f(245, 245, 245) : cv::Vec3f(20, 20, 200);
  return from + (to - from) * toward;
}

}  // namespace

DisparityErrors evaluateDisparity(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask) {
  checkMaps(disparity, truth, mask);
  Tally tally;
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      const float t = truth.at<float>(y, x);
      if (std::isfinite(t) && scored(mask, y, x)) tally.add(disparity.at<float>(y, x), t);
    }
  }
  if (tally.pixels == 0) throw std::invalid_argument("no pixel has a truth to be scored against");
  const auto share = [](std::int64_t part, std::int64_t whole) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  };
  DisparityErrors errors;
  const auto answers = static_cast<std::int64_t>(tally.errors_px.size());
  const std::int64_t unanswered = tally.pixels - answers;
  for (std::size_t i = 0; i < errors.bad.size(); ++i) errors.bad[i] = share(tally.above[i] + unanswered, tally.pixels);
  errors.d1 = share(tally.outliers + unanswered, tally.pixels);
  errors.density = share(answers, tally.pixels);
  if (answers > 0) {
    errors.sparse_bad_half = share(tally.above[2], answers);
    errors.average_px = meanOf(tally.errors_px);
    errors.a95_px = quantileOf(tally.errors_px);
  }
  return errors;
}

DisparityErrors averageErrors(const std::vector<DisparityErrors>& errors, const std::vector<double>& weights) {
  double total = 0.0;
  for (const double weight : weights) total += weight;
  if (errors.empty() || errors.size() != weights.size() || !(total > 0.0)) {
    throw std::invalid_argument("an average needs scenes and one weight for each, not " +
                                std::to_string(errors.size()) + " and " + std::to_string(weights.size()));
  }
  DisparityErrors mean;
  mean.sparse_bad_half = 0.0;
  mean.average_px = 0.0;
  mean.a95_px = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double weight = weights[i] / total;
    for (std::size_t t = 0; t < mean.bad.size(); ++t) mean.bad[t] += weight * errors[i].bad[t];
    mean.d1 += weight * errors[i].d1;
    mean.density += weight * errors[i].density;
    mean.sparse_bad_half += weight * errors[i].sparse_bad_half;
    mean.average_px += weight * errors[i].average_px;
    mean.a95_px += weight * errors[i].a95_px;
  }
  return mean;
}

double middleburyWeight(const std::string& scene_name) {
  static const std::vector<std::string> half = {"PianoL", "Playroom", "Playtable", "Shelves", "Vintage"};
  const std::string name = scene_name.substr(0, scene_name.find('+'));
  return std::find(half.begin(), half.end(), name) == half.end() ? 1.0 : 0.5;
}

cv::Mat colorizeErrors(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask) {
  checkMaps(disparity, truth, mask);
  cv::Mat colors(truth.size(), CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      const float t = truth.at<float>(y, x);
      if (!std::isfinite(t)) continue;
      const float d = disparity.at<float>(y, x);
      const cv::Vec3b color = answered(d) ? errorColor(std::abs(d - t)) : kNoAnswerColor;
      colors.at<cv::Vec3b>(y, x) = scored(mask, y, x) ? color : color / 3;
    }
  }
  return colors;
}

Seeds simulateSeeds(const cv::Mat& truth, DisparityRange range, const SeedSimulation& simulation) {
  cv::RNG rng(simulation.random_seed);
  Seeds seeds;
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      // All are drawn at every pixel, so that one option does not change what the others do.
      const bool chosen = rng.uniform(0.0, 1.0) < simulation.share;
      const bool wrong = rng.uniform(0.0, 1.0) < simulation.outliers;
      const double anything = rng.uniform(static_cast<double>(range.min), static_cast<double>(range.max()));
      const double noise = rng.gaussian(simulation.noise_px);
      const double d = truth.at<float>(y, x);
      if (!chosen || std::isnan(d)) continue;
      Seed seed;
      seed.x = static_cast<float>(x);
      seed.y = static_cast<float>(y);
      seed.d = static_cast<float>(wrong ? anything : d + noise);
      seed.source = SeedSource::kFile;
      seeds.push_back(seed);
    }
  }
  return seeds;
}

}  // namespace fdp_stereo
