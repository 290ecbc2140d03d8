// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// parameters_doc: prints docs/parameters.md from the list of parameters and the presets.
#include <algorithm>
#include <iostream>
#include <sstream>

#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {
namespace {

std::string rangeText(const ParamRef& ref) {
  std::ostringstream text;
  if (const auto* choice = std::get_if<EnumRef>(&ref.value)) {
    for (std::size_t i = 0; i < choice->names.size(); ++i) text << (i == 0 ? "" : ", ") << choice->names[i];
  } else if (std::holds_alternative<bool*>(ref.value)) {
    text << "true, false";
  } else {
    text << ref.min << " to " << ref.max << (ref.unit.empty() ? "" : " " + ref.unit);
  }
  return text.str();
}

std::string rosName(const ParamRef& ref) {
  const std::string name = "`" + ref.ros_name + "`";
  return ref.step == TuningStep::kExpert ? name : "**" + name + "**";
}

void printHead() {
  std::cout
      << "# Parameters\n\n"
         "Made by `parameters_doc` from the list in `src/core/params/parameter_list.cpp`; do not edit by hand.\n\n"
         "A parameter has a key, `stage.name`, and a name in ROS, in the last column. YAML files (keys nested or "
         "dotted)\n"
         "and `--set NAME=VALUE` take both, and so do private parameters of the node; dynamic_reconfigure shows the "
         "name\n"
         "in ROS, those in bold in its first groups. An unknown name is an error that gives the nearest one. The\n"
         "defaults are the preset `fast`; the other presets, in `config/`, list what differs. `preset: NAME` in a "
         "YAML\n"
         "file begins with another one. What `rosparam dump` and `dynparam dump` write of a node is such a file, too;\n"
         "the tools pass over what belongs to the node.\n";
}

void printTable() {
  PipelineParams defaults;
  std::vector<std::string> presets = presetNames();
  presets.erase(std::remove(presets.begin(), presets.end(), "fast"), presets.end());
  std::vector<PipelineParams> values;
  for (const std::string& preset : presets) values.push_back(loadPreset(preset));
  std::vector<std::vector<ParamRef>> columns;
  for (PipelineParams& value : values) columns.push_back(paramList(value));
  const std::vector<ParamRef> refs = paramList(defaults);
  std::string stage;
  for (std::size_t i = 0; i < refs.size(); ++i) {
    const std::size_t dot = refs[i].key.find('.');
    if (refs[i].key.substr(0, dot) != stage) {
      stage = refs[i].key.substr(0, dot);
      std::cout << "\n## " << stage << "\n\n| name | default, fast |";
      for (const std::string& preset : presets) std::cout << ' ' << preset << " |";
      std::cout << " allowed | effect | ROS name |\n|---|---|";
      for (std::size_t p = 0; p < presets.size(); ++p) std::cout << "---|";
      std::cout << "---|---|---|\n";
    }
    std::cout << "| `" << refs[i].key.substr(dot + 1) << "` | " << toString(refs[i]) << " |";
    for (const auto& column : columns) std::cout << ' ' << toString(column[i]) << " |";
    std::cout << ' ' << rangeText(refs[i]) << " | " << refs[i].text << " | " << rosName(refs[i]) << " |\n";
  }
}

}  // namespace
}  // namespace fdp_stereo

int main() {
  fdp_stereo::printHead();
  fdp_stereo::printTable();
  return 0;
}
