// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluation/scene.hpp"

namespace fdp_stereo {

/// One method with everything that it keeps from frame to frame, on one scene.
struct Contestant {
  std::string name;
  std::function<std::vector<StageTime>()> run;  ///< one frame; the stages that it took
  std::function<cv::Mat()> disparity;           ///< of the last run, filled, CV_32FC1 px
};

/// Figures of one method on one scene.
struct Score {
  std::string method;
  double median_ms = 0.0;         ///< wall time of a frame
  double median_cpu_ms = 0.0;     ///< CPU time of the whole process meanwhile
  std::vector<StageTime> stages;  ///< medians
  double peak_memory_mb = 0.0;    ///< of a process that runs nothing else
  cv::Mat disparity;
};

/// Names that makeContestant() takes: presets "fast", "light", "accurate", "paper", and OpenCV's "sgbm_hh",
/// "sgbm_3way", "bm".
const std::vector<std::string>& contestantNames();

/// A preset with holes filled and the range of the scene, or a matcher of OpenCV. Throws std::invalid_argument for
/// another name.
Contestant makeContestant(const std::string& name, const Scene& scene, int threads);

/// Of at least one value.
double median(std::vector<double> values);

/// One frame of each to warm up, then `runs` rounds in which each has its turn. Medians.
std::vector<Score> runContest(const std::vector<std::string>& names, const Scene& scene, int threads, int runs);

}  // namespace fdp_stereo
