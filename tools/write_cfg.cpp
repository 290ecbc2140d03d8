// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Writes the cfg file of dynamic_reconfigure as the list of parameters defines it.
#include <algorithm>
#include <iostream>
#include <sstream>

#include "node_params.hpp"

namespace fdp_stereo {
namespace {

/// dynamic_reconfigure allows no straight quotes or backslashes in texts.
std::string quoted(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += (c == '"' || c == '\'' || c == '\\') ? std::string("\u2019") : std::string(1, c);
  return "\"" + safe + "\"";
}

std::string pythonNumber(const ParamRef& ref, double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  const bool plain_integer = text.str().find_first_of(".e") == std::string::npos;
  return text.str() + (!isWhole(ref) && plain_integer ? ".0" : "");
}

/// The lines of one choice: its constants and the enum that names them.
std::string enumLines(const ParamRef& ref, const EnumRef& choice) {
  std::string lines = ref.ros_name + " = gen.enum([\n";
  for (std::size_t i = 0; i < choice.names.size(); ++i) {
    lines += "    gen.const(" + quoted(ref.ros_name + "_" + choice.names[i]) + ", int_t, " + std::to_string(i) + ", " +
             quoted(choice.names[i]) + "),\n";
  }
  return lines + "], " + quoted(ref.text) + ")\n";
}

std::string parameterLines(const ParamRef& ref) {
  const std::string name = quoted(ref.ros_name);
  const std::string text = quoted(ref.text + (ref.unit.empty() ? "" : " [" + ref.unit + "]"));
  if (std::holds_alternative<bool*>(ref.value)) {
    return "group.add(" + name + ", bool_t, 0, " + text + ", " + (toNumber(ref) != 0.0 ? "True" : "False") + ")\n";
  }
  const std::string numbers =
      pythonNumber(ref, toNumber(ref)) + ", " + pythonNumber(ref, ref.min) + ", " + pythonNumber(ref, ref.max);
  if (const auto* choice = std::get_if<EnumRef>(&ref.value)) {
    return enumLines(ref, *choice) + "group.add(" + name + ", int_t, 0, " + text + ", " + numbers +
           ", edit_method=" + ref.ros_name + ")\n";
  }
  return "group.add(" + name + ", " + (isWhole(ref) ? "int_t" : "double_t") + ", 0, " + text + ", " + numbers + ")\n";
}

/// The name and type of each tuning step's group. rqt sorts groups by name.
std::string groupOf(const ParamRef& ref, int expert_group) {
  static const char* const kNames[] = {"search", "smoothness", "filters", "seeds", "node"};
  if (ref.step != TuningStep::kExpert) {
    const auto step = static_cast<std::size_t>(ref.step);
    return quoted("basic_" + std::to_string(step + 1) + "_" + kNames[step]);
  }
  const std::string number = (expert_group < 10 ? "0" : "") + std::to_string(expert_group);
  return quoted("expert_" + number + "_" + ref.key.substr(0, ref.key.find('.'))) + ", type=\"collapse\", state=False";
}

std::string presetLines() {
  std::vector<std::string> names = presetNames();
  names.emplace_back(kCustomPreset);
  std::string lines = "preset = gen.enum([\n";
  for (const std::string& name : names) {
    lines += "    gen.const(" + quoted("preset_" + name) + ", str_t, " + quoted(name) + ", " + quoted(name) + "),\n";
  }
  const std::string text = quoted(
      "Sets all but the search range, what concerns the machine, and the node; custom where a value was changed "
      "since.");
  return lines + "], " + text + ")\ngroup.add(\"preset\", str_t, 0, " + text + ", " + quoted(kDefaultPreset) +
         ", edit_method=preset)\n";
}

std::string reconfigureFile() {
  NodeSettings settings;
  std::string file =
      "#!/usr/bin/env python3\n"
      "# SPDX-FileCopyrightText: 2026 The fdp_stereo authors\n"
      "# SPDX-License-Identifier: BSD-3-Clause\n"
      "#\n"
      "# Written by the build target update_cfg from the one list of parameters; a test compares.\n"
      "from dynamic_reconfigure.parameter_generator_catkin import ParameterGenerator, bool_t, double_t, int_t, "
      "str_t\n\n"
      "gen = ParameterGenerator()\n";
  std::vector<ParamRef> refs = liveParamList(settings);
  std::stable_sort(refs.begin(), refs.end(), [](const ParamRef& a, const ParamRef& b) { return a.step < b.step; });
  std::string stage;
  int expert_group = 0;
  for (const ParamRef& ref : refs) {
    const bool expert = ref.step == TuningStep::kExpert;
    const std::string of = expert ? ref.key.substr(0, ref.key.find('.')) : std::to_string(static_cast<int>(ref.step));
    if (of != stage) {
      if (expert) ++expert_group;
      file += "\ngroup = gen.add_group(" + groupOf(ref, expert_group) + ")\n";
      if (stage.empty()) file += presetLines();
      stage = of;
    }
    file += parameterLines(ref);
  }
  return file + "\nexit(gen.generate(\"fdp_stereo\", \"disparity\", \"Disparity\"))\n";
}

}  // namespace
}  // namespace fdp_stereo

int main() { std::cout << fdp_stereo::reconfigureFile(); }
