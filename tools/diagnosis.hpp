// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>

#include "conversions.hpp"
#include "fdp_stereo/types.hpp"
#include "frame_worker.hpp"

/// What is wrong with a stereo camera's topics, in plain words. No node needed.
namespace fdp_stereo {

struct TopicObservation {
  std::string topic;  ///< resolved
  std::uint32_t publishers = 0;
  std::vector<ros::Time> stamps;  ///< of the messages that came
};

/// What was seen of a running graph for a while.
struct Observation {
  double seconds = 0.0;
  std::array<TopicObservation, 4> inputs;  ///< left image, left info, right image, right info
  std::optional<StereoFrame> pair;         ///< images and infos nearest to each other in time
  std::uint32_t disparity_publishers = 0;
  std::size_t disparities = 0;  ///< messages from the node
  std::string node;             ///< its resolved name, for what to type
  DisparityRange range;         ///< that it searches
  bool approximate_sync = false;
  double tolerance_s = 0.0;  ///< of the approximate synchronisation; 0 = none
};

enum class Verdict { kGood, kOdd, kWrong };

struct Finding {
  Verdict verdict;
  std::string text;
  std::string remedy;  ///< what to do or to type; empty where all is well
};

/// In the order of the way: topics, stamps, calibration and images, rectification, range, output. Later checks need
/// earlier ones and are left out where those failed.
std::vector<Finding> diagnose(const Observation& observation);

}  // namespace fdp_stereo
