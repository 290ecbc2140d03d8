// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "evaluation/scene.hpp"
#include "fdp_stereo/pipeline.hpp"

namespace fdp_stereo {

/// A stereo method that can be run on a scene: a set of our parameters, or a peer.
struct Method {
  std::string name;
  std::string settings;  ///< all that its result depends on, as text
  std::function<PipelineResult(const Scene&)> run;
};

/// Our pipeline with a preset and the options over it. The scene gives the range unless the options do. With a share
/// above 0, seeds made from the truth go in beside the images.
Method pipelineMethod(const std::string& name, const std::string& preset, const PipelineOptions& options,
                      const SeedSimulation& seeds);

/// "NAME=PRESET[,stage.key=value...]", the options applying first. Throws UsageError.
Method variantMethod(const std::string& text, const PipelineOptions& options, const SeedSimulation& seeds);

/// OpenCV's matchers as PeerMatcher sets them.
std::vector<Method> peerMethods(bool fill);

}  // namespace fdp_stereo
