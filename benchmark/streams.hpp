// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/scene.hpp"

namespace fdp_stereo {

/// One pair of a stream. What is not known is empty.
struct StreamFrame {
  cv::Mat left, right;
  cv::Mat truth;    ///< CV_32FC1 px
  cv::Mat visible;  ///< CV_8UC1, 255 where both views see a pixel whose truth is known
  cv::Mat object;   ///< CV_8UC1, 255 on the object that moves
};

struct Stream {
  std::string name;
  int num_disparities = 0;
  std::vector<StreamFrame> frames;
};

/// kStatic: nothing moves. kPan: the camera, 4 px to the right and 1 px down per pair. kObject: a textured ellipse in
/// front of all passes, 9 px per pair.
enum class Motion { kStatic, kPan, kObject };

/// A scene as a stream, with fresh noise of this standard deviation in every pair.
Stream makeStream(const Scene& scene, Motion motion, int frames, double noise);

/// A recording in EuRoC's form: mav0/cam0/data and mav0/cam1/data beside left.yaml and right.yaml (camera_calibration),
/// rectified. Throws std::runtime_error where something of it is missing.
Stream readRecording(const std::string& folder, int num_disparities);

}  // namespace fdp_stereo
