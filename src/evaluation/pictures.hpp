// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/scene.hpp"
#include "fdp_stereo/pipeline.hpp"

namespace fdp_stereo {

/// The picture of a scene in the folder of a report: "<scene>/left.png", or "<scene>/<method>_<kind>.png".
std::string pictureName(const std::string& scene, const std::string& method, const std::string& kind);

/// left.png and truth.png (in colours) of a scene. Throws std::runtime_error naming a file that cannot be written.
void writeScenePictures(const std::string& folder, const Scene& scene);

/// disparity, errors, invalid and, where there are any, seeds of one method on a scene.
void writeMethodPictures(const std::string& folder, const Scene& scene, const std::string& method,
                         const PipelineResult& result);

}  // namespace fdp_stereo
