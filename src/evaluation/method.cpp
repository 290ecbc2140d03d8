// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/method.hpp"

#include <sstream>

#include "evaluation/peer.hpp"

namespace fdp_stereo {
namespace {

PipelineResult runPeer(Peer peer, bool fill, const Scene& scene) {
  PeerMatcher matcher(peer, scene);
  matcher.compute();
  PipelineResult result;
  result.disparity = matcher.disparity();
  if (fill) fillHoles(result.disparity);
  return result;
}

std::string describeSeeds(const SeedSimulation& seeds) {
  if (seeds.share <= 0.0) return "";
  std::ostringstream text;
  text << "# seeds from the truth: share " << seeds.share << ", noise " << seeds.noise_px << " px, outliers "
       << seeds.outliers << ", random seed " << seeds.random_seed << '\n';
  return text.str();
}

Method paramsMethod(const std::string& name, const PipelineParams& params, bool own_range,
                    const SeedSimulation& seeds) {
  const auto run = [params, own_range, seeds](const Scene& scene) {
    PipelineParams scene_params = params;
    if (!own_range) scene_params.search = {0, scene.num_disparities};
    const Seeds external = seeds.share > 0.0 ? simulateSeeds(scene.truth, scene_params.search, seeds) : Seeds();
    return Pipeline(scene_params).run(scene.left, scene.right, external);
  };
  return {name, toYaml(params) + (own_range ? "" : "# the scene gives the range\n") + describeSeeds(seeds), run};
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

}  // namespace

Method pipelineMethod(const std::string& name, const std::string& preset, const PipelineOptions& options,
                      const SeedSimulation& seeds) {
  return paramsMethod(name, resolveParams(preset, options), options.num_disparities.has_value(), seeds);
}

Method variantMethod(const std::string& text, const PipelineOptions& options, const SeedSimulation& seeds) {
  const std::size_t equals = text.find('=');
  const std::vector<std::string> parts = split(equals == std::string::npos ? "" : text.substr(equals + 1), ',');
  if (equals == 0 || parts.empty()) {
    throw UsageError("--variant '" + text + "': must be NAME=PRESET[,stage.key=value...]");
  }
  PipelineOptions extended = options;
  extended.assignments.insert(extended.assignments.end(), parts.begin() + 1, parts.end());
  return pipelineMethod(text.substr(0, equals), parts[0], extended, seeds);
}

std::vector<Method> peerMethods(bool fill) {
  std::vector<Method> methods;
  for (const Peer peer : {Peer::kSgbmHh, Peer::kSgbm3Way, Peer::kBm}) {
    const std::string settings =
        std::string("OpenCV ") + CV_VERSION + " " + peerName(peer) + (fill ? " filled\n" : "\n");
    methods.push_back(
        {peerName(peer), settings, [peer, fill](const Scene& scene) { return runPeer(peer, fill, scene); }});
  }
  return methods;
}

}  // namespace fdp_stereo
