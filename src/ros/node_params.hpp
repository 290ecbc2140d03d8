// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {

/// What only the node needs, beside the pipeline's parameters.
struct NodeParams {
  double max_rate_hz = 0.0;  ///< pairs per second by their stamps; 0 = every pair
  double max_age_s = 0.0;    ///< an older pair is dropped; 0 = off, as bags need it
  double deadline_ms = 0.0;  ///< of the processing of a pair, which smaller images keep; 0 = off
  int nice = 0;              ///< of the working threads, 0..19
  double min_depth_m = 0.0;
  double max_depth_m = 0.0;            ///< 0 = none
  double max_depth_error_m = 0.0;      ///< 1 sigma; 0 = none
  double min_confidence = 0.0;         ///< 0..1
  double seeds_points_trust = 0.95;    ///< 0..1, share of the seeds of this source that are right; 0 = it is not used
  double seeds_depth_trust = 0.9;      ///< likewise
  double seeds_disparity_trust = 0.9;  ///< likewise
  double seeds_spacing_px = 4.0;       ///< one seed per square of this side
  double seeds_max_age_s = 0.1;        ///< farther from the image in time, a seed message is not used
  double seeds_wait_s = 0.0;           ///< a pair waits at most this long for seeds of its time
};

/// The preset of a node that is told nothing.
constexpr char kDefaultPreset[] = "fast";
/// In place of a preset's name where the values are those of none.
constexpr char kCustomPreset[] = "custom";

/// One consistent set: a frame is processed with one of them, whole.
struct NodeSettings {
  PipelineParams pipeline;
  NodeParams node;
  std::string preset = kDefaultPreset;  ///< whose values the pipeline has, or kCustomPreset
  unsigned revision = 0;                ///< counts the edits
};

/// Every parameter that can be edited live: paramList(), then the node's. The references live as long as `settings`.
std::vector<ParamRef> liveParamList(NodeSettings& settings);

/// Throws std::invalid_argument as validate() of the pipeline does.
void validate(const NodeSettings& settings);

}  // namespace fdp_stereo
