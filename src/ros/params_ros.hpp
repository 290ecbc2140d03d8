// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <XmlRpcValue.h>
#include <dynamic_reconfigure/Config.h>

#include "node_params.hpp"

/// dynamic_reconfigure and the parameter server to and from the one list of parameters; no node needed.
namespace fdp_stereo {

/// Overwrites the values in `config` (bools, ints, doubles by their ROS name; a choice is the index of its name).
void toConfig(const NodeSettings& settings, dynamic_reconfigure::Config& config);

/// `current` with the values of `edits`; values outside their range are clamped; values that do not go together are
/// left as they were. Each correction adds a line to `messages`, all unknown names add one. A preset among the edits is
/// loaded first and keeps the search range, what concerns the machine, and the node. The revision grows where a value
/// changed.
NodeSettings applyConfig(const dynamic_reconfigure::Config& edits, const NodeSettings& current,
                         std::vector<std::string>& messages);

/// The same from a private namespace of the parameter server: ROS names or keys, flat or in maps as in a YAML preset;
/// choices by name or index. Names in `others` are not ours to judge.
NodeSettings applyRosparam(const XmlRpc::XmlRpcValue& values, const NodeSettings& current,
                           const std::vector<std::string>& others, std::vector<std::string>& messages);

/// The same from a YAML file or text.
NodeSettings applyYaml(const std::vector<NamedText>& values, const NodeSettings& current,
                       const std::vector<std::string>& others, std::vector<std::string>& messages);

}  // namespace fdp_stereo
