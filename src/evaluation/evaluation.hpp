// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

constexpr std::array<double, 6> kBadThresholdsPx = {0.125, 0.25, 0.5, 1.0, 2.0, 3.0};
constexpr double kOutlierShare = 0.05;  ///< of the true disparity, for D1
constexpr double kMaxErrorPx = 100.0;   ///< an error counts at most this much in average and quantile

/// Errors over the scored pixels that have a truth; a pixel without answer counts as bad. Shares in %.
struct DisparityErrors {
  std::array<double, 6> bad{};     ///< share with an error above each of kBadThresholdsPx
  double d1 = 0.0;                 ///< KITTI 2015: share with an error above 3 px and kOutlierShare of the truth
  double density = 0.0;            ///< share with an answer
  double sparse_bad_half = 100.0;  ///< bad 0.5 among the answered
  double average_px = 100.0;       ///< mean error of the answered, each capped at kMaxErrorPx
  double a95_px = 100.0;           ///< 95 % of the answered are off by at most this much, capped likewise
};

/// Compares two maps of one size, CV_32FC1 px; in `disparity` NaN, infinity and negative values are no answer, in
/// `truth` NaN is unknown. mask: CV_8UC1, 255 = scored, or empty = all. Throws std::invalid_argument when sizes or
/// types differ or no pixel can be scored.
DisparityErrors evaluateDisparity(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask);

/// Mean of several scenes' errors, each times its weight. Throws std::invalid_argument for no scene or no weight above
/// 0.
DisparityErrors averageErrors(const std::vector<DisparityErrors>& errors, const std::vector<double>& weights);

/// Weight of a scene in the Middlebury V3 average: 0.5 for PianoL, Playroom, Playtable, Shelves and Vintage, else 1. A
/// kind of corruption that follows the name ("Vintage+noise") changes nothing.
double middleburyWeight(const std::string& scene_name);

/// Errors as colours, CV_8UC3: blue (none) over white (1 px) to red (4 px and more), black = no truth, dark where
/// the mask is not 255, magenta = no answer.
cv::Mat colorizeErrors(const cv::Mat& disparity, const cv::Mat& truth, const cv::Mat& mask);

/// Another sensor's seeds, made from a true disparity map.
struct SeedSimulation {
  double share = 0.005;    ///< 0..1 of the pixels become seeds
  double noise_px = 0.25;  ///< standard deviation of d
  double outliers = 0.05;  ///< 0..1 of the seeds have a d drawn from the whole range
  std::uint64_t random_seed = 1;
};

/// Seeds (SeedSource::kFile, trust 1) at some of the pixels whose truth (CV_32FC1 px, NaN = unknown) is known, sorted
/// by (y, x). The same arguments give the same seeds, and more of one share does not move the others.
Seeds simulateSeeds(const cv::Mat& truth, DisparityRange range, const SeedSimulation& simulation);

}  // namespace fdp_stereo
