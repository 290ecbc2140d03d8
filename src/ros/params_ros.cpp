// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params_ros.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace fdp_stereo {
namespace {

/// One wish for one parameter, already as a number: bool 0/1, a choice by index.
struct Edit {
  std::string ros_name;
  double value;
};

/// Sets what can be set; returns what had to be said, "" for nothing.
std::string setClamped(const ParamRef& ref, double number) {
  if (std::isnan(number)) return ref.ros_name + " = nan is not a number; kept " + toString(ref);
  const double allowed = std::clamp(isWhole(ref) ? std::round(number) : number, ref.min, ref.max);
  setFromNumber(ref, allowed);
  if (allowed == number) return "";
  std::ostringstream text;
  text << ref.ros_name << " = " << number << " is not possible (" << ref.min << " to " << ref.max
       << (isWhole(ref) ? ", whole numbers" : "") << "); set to " << toString(ref);
  return text.str();
}

bool isValid(const NodeSettings& settings, std::string& problem) {
  try {
    validate(settings);
    return true;
  } catch (const std::invalid_argument& error) {
    problem = error.what();
    return false;
  }
}

/// Where the edits do not go together as a whole, they are tried one by one until none more can be taken.
NodeSettings applyOneByOne(const std::vector<Edit>& edits, const NodeSettings& current,
                           std::vector<std::string>& messages) {
  NodeSettings settings = current;
  std::vector<Edit> open = edits;
  std::string problem;
  bool progress = true;
  while (progress && !open.empty()) {
    progress = false;
    for (auto edit = open.begin(); edit != open.end();) {
      NodeSettings trial = settings;
      const auto refs = liveParamList(trial);
      setClamped(*findParam(refs, edit->ros_name), edit->value);
      if (isValid(trial, problem)) {
        settings = trial;
        edit = open.erase(edit);
        progress = true;
      } else {
        ++edit;
      }
    }
  }
  for (const Edit& edit : open) {
    const auto refs = liveParamList(settings);
    messages.push_back(edit.ros_name + " stays " + toString(*findParam(refs, edit.ros_name)) + ": " + problem);
  }
  return settings;
}

bool sameValues(const std::vector<ParamRef>& a, const std::vector<ParamRef>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const ParamRef& x, const ParamRef& y) { return toNumber(x) == toNumber(y); });
}

bool sameValues(NodeSettings a, NodeSettings b) { return sameValues(liveParamList(a), liveParamList(b)); }

/// The preset whose values these are, whatever search and machine are.
std::string presetOf(PipelineParams params) {
  for (const std::string& name : presetNames()) {
    PipelineParams preset = params;
    usePreset(preset, name);
    if (sameValues(paramList(preset), paramList(params))) return name;
  }
  return kCustomPreset;
}

NodeSettings applyEdits(const std::vector<Edit>& edits, const NodeSettings& current,
                        std::vector<std::string>& messages) {
  NodeSettings settings = current;
  const auto refs = liveParamList(settings);
  for (const Edit& edit : edits) {
    const std::string message = setClamped(*findParam(refs, edit.ros_name), edit.value);
    if (!message.empty()) messages.push_back(message);
  }
  std::string problem;
  if (!isValid(settings, problem)) settings = applyOneByOne(edits, current, messages);
  return settings;
}

/// `next` as the successor of `current`.
NodeSettings succeed(NodeSettings next, const NodeSettings& current) {
  next.preset = presetOf(next.pipeline);
  next.revision = current.revision + (sameValues(next, current) ? 0 : 1);
  return next;
}

/// One message for all names that are in no list.
void reportUnknown(const std::vector<std::string>& names, const std::vector<ParamRef>& refs,
                   std::vector<std::string>& messages) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "'" : ", '") + name + "' (" + adviceFor(refs, name) + ")";
  }
  if (!text.empty()) messages.push_back("not known, so it has no effect: " + text);
}

/// A scalar of the parameter server as a number; throws std::invalid_argument for what is none.
double numberIn(const XmlRpc::XmlRpcValue& const_value, const ParamRef& ref) {
  XmlRpc::XmlRpcValue value = const_value;  // its conversions are not const
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? 1.0 : 0.0;
    case XmlRpc::XmlRpcValue::TypeInt:
      return static_cast<int>(value);
    case XmlRpc::XmlRpcValue::TypeDouble:
      return static_cast<double>(value);
    case XmlRpc::XmlRpcValue::TypeString: {
      const double before = toNumber(ref);
      setFromString(ref, static_cast<std::string>(value));
      const double number = toNumber(ref);
      setFromNumber(ref, before);
      return number;
    }
    default:
      throw std::invalid_argument(ref.ros_name + ": a number, a word, true or false is needed");
  }
}

/// Collects the edits in a namespace of the parameter server.
class RosparamReader {
 public:
  RosparamReader(const NodeSettings& current, const std::vector<std::string>& others,
                 std::vector<std::string>& messages)
      : settings_(current), refs_(liveParamList(settings_)), others_(others), messages_(messages) {}

  std::vector<Edit> read(XmlRpc::XmlRpcValue values) {
    if (values.getType() == XmlRpc::XmlRpcValue::TypeStruct) readMap(values, "");
    reportUnknown(unknown_, refs_, messages_);
    return std::move(edits_);
  }

 private:
  void readMap(XmlRpc::XmlRpcValue& values, const std::string& prefix) {
    for (auto& [name, value] : values) {
      const std::string full = prefix + name;
      if (const ParamRef* ref = findParam(refs_, full)) {
        add(*ref, value);
      } else if (std::find(others_.begin(), others_.end(), full) != others_.end()) {
        continue;
      } else if (value.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
        readMap(value, full + ".");
      } else {
        unknown_.push_back(full);
      }
    }
  }

  void add(const ParamRef& ref, const XmlRpc::XmlRpcValue& value) {
    try {
      edits_.push_back({ref.ros_name, numberIn(value, ref)});
    } catch (const std::invalid_argument& error) {
      messages_.push_back(std::string(error.what()) + "; kept " + toString(ref));
    }
  }

  NodeSettings settings_;
  std::vector<ParamRef> refs_;
  const std::vector<std::string>& others_;
  std::vector<std::string>& messages_;
  std::vector<std::string> unknown_;
  std::vector<Edit> edits_;
};

template <typename Entries, typename Value>
void setEntry(Entries& entries, const std::string& name, Value value) {
  for (auto& entry : entries) {
    if (entry.name == name) {
      entry.value = value;
      return;
    }
  }
  entries.emplace_back();
  entries.back().name = name;
  entries.back().value = value;
}

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

void toConfig(const NodeSettings& settings, dynamic_reconfigure::Config& config) {
  NodeSettings copy = settings;
  for (const ParamRef& ref : liveParamList(copy)) {
    if (std::holds_alternative<bool*>(ref.value)) {
      setEntry(config.bools, ref.ros_name, static_cast<std::uint8_t>(toNumber(ref)));
    } else if (isWhole(ref)) {
      setEntry(config.ints, ref.ros_name, static_cast<std::int32_t>(toNumber(ref)));
    } else {
      setEntry(config.doubles, ref.ros_name, toNumber(ref));
    }
  }
  setEntry(config.strs, "preset", settings.preset);
}

NodeSettings applyConfig(const dynamic_reconfigure::Config& edits, const NodeSettings& current,
                         std::vector<std::string>& messages) {
  NodeSettings before = current;
  NodeSettings base = current;
  std::vector<std::string> unknown;
  for (const auto& entry : edits.strs) {
    if (entry.name != "preset") {
      unknown.push_back(entry.name);
    } else if (isPreset(entry.value)) {
      if (entry.value != current.preset) usePreset(base.pipeline, entry.value);
    } else if (entry.value != kCustomPreset) {
      messages.push_back("preset = " + entry.value + " is none that can be chosen live; kept " + current.preset);
    }
  }
  const bool preset_chosen = !sameValues(base, current);
  const auto refs = liveParamList(before);
  std::vector<Edit> numbers;
  const auto collect = [&](const auto& entries) {
    for (const auto& entry : entries) {
      const ParamRef* ref = findParam(refs, entry.name);
      const auto value = static_cast<double>(entry.value);
      if (ref == nullptr) {
        unknown.push_back(entry.name);
      } else if (!preset_chosen ||
                 value != toNumber(*ref)) {  // a client may send all values beside the preset it chose
        numbers.push_back({ref->ros_name, value});
      }
    }
  };
  collect(edits.bools);
  collect(edits.ints);
  collect(edits.doubles);
  reportUnknown(unknown, refs, messages);
  return succeed(applyEdits(numbers, base, messages), current);
}

NodeSettings applyRosparam(const XmlRpc::XmlRpcValue& values, const NodeSettings& current,
                           const std::vector<std::string>& others, std::vector<std::string>& messages) {
  return succeed(applyEdits(RosparamReader(current, others, messages).read(values), current, messages), current);
}

NodeSettings applyYaml(const std::vector<NamedText>& values, const NodeSettings& current,
                       const std::vector<std::string>& others, std::vector<std::string>& messages) {
  NodeSettings base = current;
  XmlRpc::XmlRpcValue map;
  for (const NamedText& value : values) {
    map[value.name] = value.text;
    if (value.name == "preset" && isPreset(value.text)) usePreset(base.pipeline, value.text);
  }
  return succeed(applyRosparam(map, base, others, messages), current);
}

std::string reconfigureFile() {
  NodeSettings settings;
  std::string file =
      "#!/usr/bin/env python3\n"
      "# SPDX-FileCopyrightText: 2026 The fdp_stereo authors\n"
      "# SPDX-License-Identifier: BSD-3-Clause\n"
      "#\n"
      "# Written by the build target update_cfg from the one list of parameters; cfg_test compares.\n"
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

}  // namespace fdp_stereo
