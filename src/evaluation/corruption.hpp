// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/scene.hpp"

namespace fdp_stereo {

/// One way to make a good pair as bad as those of robots are.
struct Corruption {
  const char* name;
  const char* strength;  ///< what it does to the pair, in grey levels of 255 and pixels
  /// Takes float views of 0 to 255; may leave that range.
  void (*apply)(cv::Mat& left, cv::Mat& right, cv::RNG& random);
};

/// "none", which leaves the pair as it is, and the others.
const std::vector<Corruption>& corruptions();

/// Their names, comma between them.
std::string corruptionNames();

/// The named ones, in capitals or not, each once, in their order above; "all" stands for all. Throws
/// std::invalid_argument with the name that there is not and all that there are.
std::vector<const Corruption*> chooseCorruptions(const std::vector<std::string>& names);

/// Spoils both views and adds "+KIND" to the name; number and type of the pixels stay. The same scene always gives the
/// same pair. White is 255, of 16-bit views the largest value of as many bits as the brighter of the two needs.
void corrupt(Scene& scene, const Corruption& corruption);

/// The kind that the name of a scene ends with, "none" for none.
std::string corruptionOf(const std::string& scene_name);

}  // namespace fdp_stereo
