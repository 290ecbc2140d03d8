// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// How much brighter an image is than the mean of earlier ones (CV_32F, as many channels): the median of the ratios.
double brightnessRatio(const cv::Mat& image, const cv::Mat& mean);

constexpr int kChangeSteps = 8;      ///< of a grey level
constexpr int kLargestChange = 255;  ///< steps; beyond it all changes are alike

/// |grey - mean| in steps, CV_8UC1.
cv::Mat changesFrom(const cv::Mat& mean, const cv::Mat& grey);

/// Standard deviation of the noise, grey levels, for every 32 grey levels: a sensor's noise grows with the light.
using NoiseLevels = std::array<double, 8>;
inline int noiseLevel(int grey) { return grey / 32; }

/// From what changes since the image before (light: how much brighter all is), at most about what the plainest places
/// show: in a view that moves all changes.
NoiseLevels measureNoise(const cv::Mat& grey, const cv::Mat& before, double light);

}  // namespace fdp_stereo
