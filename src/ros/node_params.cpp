// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "node_params.hpp"

#include <stdexcept>

namespace fdp_stereo {
namespace {

void addSeedSource(std::vector<ParamRef>& refs, const std::string& source, double& trust) {
  refs.push_back({"seeds." + source + "_trust", &trust, 0.0, 1.0, "",
                  "Share of the seeds from seeds/" + source + " that are right; 0 leaves the source out.",
                  "seeds_" + source + "_trust", TuningStep::kSeeds});
}

void addSeeds(std::vector<ParamRef>& refs, NodeParams& n) {
  addSeedSource(refs, "points", n.seeds_points_trust);
  addSeedSource(refs, "depth", n.seeds_depth_trust);
  addSeedSource(refs, "disparity", n.seeds_disparity_trust);
  refs.push_back({"seeds.spacing_px", &n.seeds_spacing_px, 1.0, 100.0, "px",
                  "One seed of a source per square of this side; larger is cheaper.", "seeds_spacing",
                  TuningStep::kExpert});
  refs.push_back({"seeds.max_age_s", &n.seeds_max_age_s, 0.0, 5.0, "s",
                  "Seeds farther from the image in time are not used.", "seeds_max_age", TuningStep::kExpert});
  refs.push_back({"seeds.wait_s", &n.seeds_wait_s, 0.0, 1.0, "s",
                  "A pair waits at most this long for seeds of its time; 0 uses what is there.", "seeds_wait",
                  TuningStep::kExpert});
}

void addNode(std::vector<ParamRef>& refs, NodeParams& n) {
  refs.push_back({"node.max_rate_hz", &n.max_rate_hz, 0.0, 100.0, "Hz",
                  "Pairs per second, by their stamps; 0 takes every pair.", "max_rate", TuningStep::kNode});
  refs.push_back({"node.max_age_s", &n.max_age_s, 0.0, 10.0, "s",
                  "A pair whose stamp is older is dropped; 0 is off, which bags played without --clock need.",
                  "max_age", TuningStep::kExpert});
  refs.push_back({"node.deadline_ms", &n.deadline_ms, 0.0, 10000.0, "ms",
                  "While pairs take longer, smaller images are matched, down to 0.3 of pipeline_scale; 0 is off.",
                  "deadline_ms", TuningStep::kExpert});
  refs.push_back({"node.nice", &n.nice, 0.0, 19.0, "",
                  "Nice level of the working threads; higher gives way to other processes, lowering it again needs "
                  "privileges.",
                  "nice", TuningStep::kExpert});
  refs.push_back({"node.min_depth_m", &n.min_depth_m, 0.0, 20.0, "m", "Nearer points are left out of depth.",
                  "min_depth", TuningStep::kNode});
  refs.push_back({"node.max_depth_m", &n.max_depth_m, 0.0, 200.0, "m",
                  "Farther points are left out of depth; 0 keeps all.", "max_depth", TuningStep::kNode});
  refs.push_back({"node.max_depth_error_m", &n.max_depth_error_m, 0.0, 10.0, "m",
                  "Points with a larger standard deviation (depth_error) are left out of depth; 0 keeps all.",
                  "max_depth_error", TuningStep::kNode});
  refs.push_back({"node.min_confidence", &n.min_confidence, 0.0, 1.0, "",
                  "Points with a smaller confidence are left out of depth; 0 keeps all.", "min_confidence",
                  TuningStep::kNode});
}

}  // namespace

std::vector<ParamRef> liveParamList(NodeSettings& settings) {
  std::vector<ParamRef> refs = paramList(settings.pipeline);
  addSeeds(refs, settings.node);
  addNode(refs, settings.node);
  return refs;
}

void validate(const NodeSettings& settings) {
  validate(settings.pipeline);
  const NodeParams& n = settings.node;
  if (n.max_depth_m > 0.0 && n.max_depth_m <= n.min_depth_m) {
    throw std::invalid_argument("max_depth = " + std::to_string(n.max_depth_m) +
                                " m: must be 0 or above min_depth = " + std::to_string(n.min_depth_m) + " m");
  }
}

}  // namespace fdp_stereo
