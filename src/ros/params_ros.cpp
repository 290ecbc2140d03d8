// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params_ros.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>

namespace fdp_stereo {
namespace {

/// One wish for one parameter, already as a number: bool 0/1, a choice by index.
struct Edit {
  std::string ros_name;
  double value;
};

template <typename... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <typename... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;

bool isWhole(const ParamRef& ref) { return !std::holds_alternative<double*>(ref.value); }

double getNumber(const ParamRef& ref) {
  return std::visit(Overloaded{[](const EnumRef& choice) { return static_cast<double>(choice.get()); },
                               [](const auto* value) { return static_cast<double>(*value); }},
                    ref.value);
}

void setNumber(const ParamRef& ref, double number) {
  std::visit(
      Overloaded{[&](const EnumRef& choice) { choice.set(static_cast<int>(number)); },
                 [&](bool* value) { *value = number != 0.0; }, [&](int* value) { *value = static_cast<int>(number); },
                 [&](double* value) { *value = number; }},
      ref.value);
}

const ParamRef* findByRosName(const std::vector<ParamRef>& refs, const std::string& name) {
  const auto found = std::find_if(refs.begin(), refs.end(), [&](const ParamRef& ref) { return ref.ros_name == name; });
  return found == refs.end() ? nullptr : &*found;
}

const ParamRef* findByKey(const std::vector<ParamRef>& refs, const std::string& key) {
  const auto found = std::find_if(refs.begin(), refs.end(), [&](const ParamRef& ref) { return ref.key == key; });
  return found == refs.end() ? nullptr : &*found;
}

/// Sets what can be set; returns what had to be said, "" for nothing.
std::string setClamped(const ParamRef& ref, double number) {
  if (std::isnan(number)) return ref.ros_name + " = nan is not a number; kept " + toString(ref);
  const double allowed = std::clamp(isWhole(ref) ? std::round(number) : number, ref.min, ref.max);
  setNumber(ref, allowed);
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
      setClamped(*findByRosName(refs, edit->ros_name), edit->value);
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
    messages.push_back(edit.ros_name + " stays " + toString(*findByRosName(refs, edit.ros_name)) + ": " + problem);
  }
  return settings;
}

bool sameValues(NodeSettings a, NodeSettings b) {
  const auto refs_a = liveParamList(a);
  const auto refs_b = liveParamList(b);
  return std::equal(refs_a.begin(), refs_a.end(), refs_b.begin(),
                    [](const ParamRef& x, const ParamRef& y) { return getNumber(x) == getNumber(y); });
}

NodeSettings applyEdits(const std::vector<Edit>& edits, const NodeSettings& current,
                        std::vector<std::string>& messages) {
  NodeSettings settings = current;
  const auto refs = liveParamList(settings);
  for (const Edit& edit : edits) {
    const std::string message = setClamped(*findByRosName(refs, edit.ros_name), edit.value);
    if (!message.empty()) messages.push_back(message);
  }
  std::string problem;
  if (!isValid(settings, problem)) settings = applyOneByOne(edits, current, messages);
  settings.revision = current.revision + (sameValues(settings, current) ? 0 : 1);
  return settings;
}

/// A scalar of the parameter server as a number; throws std::invalid_argument for what is none.
double toNumber(const XmlRpc::XmlRpcValue& const_value, const ParamRef& ref) {
  XmlRpc::XmlRpcValue value = const_value;  // its conversions are not const
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? 1.0 : 0.0;
    case XmlRpc::XmlRpcValue::TypeInt:
      return static_cast<int>(value);
    case XmlRpc::XmlRpcValue::TypeDouble:
      return static_cast<double>(value);
    case XmlRpc::XmlRpcValue::TypeString: {
      const double before = getNumber(ref);
      setFromString(ref, static_cast<std::string>(value));
      const double number = getNumber(ref);
      setNumber(ref, before);
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

  std::vector<Edit> read(const XmlRpc::XmlRpcValue& const_values) {
    XmlRpc::XmlRpcValue values = const_values;
    if (values.getType() != XmlRpc::XmlRpcValue::TypeStruct) return {};
    for (auto& [name, value] : values) {
      if (const ParamRef* ref = findByRosName(refs_, name)) {
        add(*ref, value);
      } else if (value.getType() == XmlRpc::XmlRpcValue::TypeStruct && isStage(name)) {
        readStage(name, value);
      } else if (std::find(others_.begin(), others_.end(), name) == others_.end()) {
        messages_.push_back("parameter '" + name + "' is not known and has no effect");
      }
    }
    return std::move(edits_);
  }

 private:
  bool isStage(const std::string& name) const {
    return std::any_of(refs_.begin(), refs_.end(),
                       [&](const ParamRef& ref) { return ref.key.compare(0, name.size() + 1, name + ".") == 0; });
  }

  void readStage(const std::string& stage, XmlRpc::XmlRpcValue& values) {
    for (auto& [name, value] : values) {
      if (const ParamRef* ref = findByKey(refs_, stage + "." + name)) {
        add(*ref, value);
      } else {
        messages_.push_back("parameter '" + stage + "/" + name + "' is not known and has no effect");
      }
    }
  }

  void add(const ParamRef& ref, const XmlRpc::XmlRpcValue& value) {
    try {
      edits_.push_back({ref.ros_name, toNumber(value, ref)});
    } catch (const std::invalid_argument& error) {
      messages_.push_back(std::string(error.what()) + "; kept " + toString(ref));
    }
  }

  NodeSettings settings_;
  std::vector<ParamRef> refs_;
  const std::vector<std::string>& others_;
  std::vector<std::string>& messages_;
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
    return "group.add(" + name + ", bool_t, 0, " + text + ", " + (getNumber(ref) != 0.0 ? "True" : "False") + ")\n";
  }
  const std::string numbers =
      pythonNumber(ref, getNumber(ref)) + ", " + pythonNumber(ref, ref.min) + ", " + pythonNumber(ref, ref.max);
  if (const auto* choice = std::get_if<EnumRef>(&ref.value)) {
    return enumLines(ref, *choice) + "group.add(" + name + ", int_t, 0, " + text + ", " + numbers +
           ", edit_method=" + ref.ros_name + ")\n";
  }
  return "group.add(" + name + ", " + (isWhole(ref) ? "int_t" : "double_t") + ", 0, " + text + ", " + numbers + ")\n";
}

void addSeedSource(std::vector<ParamRef>& refs, const std::string& source, double& trust) {
  refs.push_back({"seeds." + source + "_trust", &trust, 0.0, 1.0, "",
                  "Share of the seeds from seeds/" + source + " that are right; 0 leaves the source out.",
                  "seeds_" + source + "_trust"});
}

void addSeeds(std::vector<ParamRef>& refs, NodeParams& n) {
  addSeedSource(refs, "points", n.seeds_points_trust);
  addSeedSource(refs, "depth", n.seeds_depth_trust);
  addSeedSource(refs, "disparity", n.seeds_disparity_trust);
  refs.push_back({"seeds.spacing_px", &n.seeds_spacing_px, 1.0, 100.0, "px",
                  "One seed of a source per square of this side; larger is cheaper.", "seeds_spacing"});
  refs.push_back({"seeds.max_age_s", &n.seeds_max_age_s, 0.0, 10.0, "s",
                  "Seeds farther from the image in time are not used.", "seeds_max_age"});
  refs.push_back({"seeds.wait_s", &n.seeds_wait_s, 0.0, 1.0, "s",
                  "A pair waits at most this long for seeds of its time; 0 uses what is there.", "seeds_wait"});
}

}  // namespace

std::vector<ParamRef> liveParamList(NodeSettings& settings) {
  NodeParams& n = settings.node;
  std::vector<ParamRef> refs = {
      {"node.max_rate_hz", &n.max_rate_hz, 0.0, 1000.0, "Hz", "Pairs per second, by their stamps; 0 takes every pair.",
       "max_rate"},
      {"node.max_age_s", &n.max_age_s, 0.0, 3600.0, "s",
       "A pair whose stamp is older is dropped; 0 is off, which bags played without --clock need.", "max_age"},
      {"node.nice", &n.nice, 0.0, 19.0, "",
       "Nice level of the working threads; higher gives way to other processes, lowering it again needs privileges.",
       "nice"},
      {"node.min_depth_m", &n.min_depth_m, 0.0, 1000.0, "m", "Nearer points are left out of depth.", "min_depth"},
      {"node.max_depth_m", &n.max_depth_m, 0.0, 10000.0, "m", "Farther points are left out of depth; 0 keeps all.",
       "max_depth"},
  };
  addSeeds(refs, n);
  const auto pipeline = paramList(settings.pipeline);
  refs.insert(refs.end(), pipeline.begin(), pipeline.end());
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
      setEntry(config.bools, ref.ros_name, static_cast<std::uint8_t>(getNumber(ref)));
    } else if (isWhole(ref)) {
      setEntry(config.ints, ref.ros_name, static_cast<std::int32_t>(getNumber(ref)));
    } else {
      setEntry(config.doubles, ref.ros_name, getNumber(ref));
    }
  }
}

NodeSettings applyConfig(const dynamic_reconfigure::Config& edits, const NodeSettings& current,
                         std::vector<std::string>& messages) {
  NodeSettings known = current;
  const auto refs = liveParamList(known);
  std::vector<Edit> numbers;
  const auto collect = [&](const auto& entries) {
    for (const auto& entry : entries) {
      if (findByRosName(refs, entry.name) != nullptr) {
        numbers.push_back({entry.name, static_cast<double>(entry.value)});
      } else {
        messages.push_back("parameter '" + entry.name + "' is not known and has no effect");
      }
    }
  };
  collect(edits.bools);
  collect(edits.ints);
  collect(edits.doubles);
  for (const auto& entry : edits.strs) messages.push_back("parameter '" + entry.name + "' is not a text");
  return applyEdits(numbers, current, messages);
}

NodeSettings applyRosparam(const XmlRpc::XmlRpcValue& values, const NodeSettings& current,
                           const std::vector<std::string>& others, std::vector<std::string>& messages) {
  return applyEdits(RosparamReader(current, others, messages).read(values), current, messages);
}

std::string reconfigureFile() {
  NodeSettings settings;
  settings.pipeline = loadPreset(kDefaultPreset);
  std::string file =
      "#!/usr/bin/env python3\n"
      "# SPDX-FileCopyrightText: 2026 The fdp_stereo authors\n"
      "# SPDX-License-Identifier: BSD-3-Clause\n"
      "#\n"
      "# Written by the build target update_cfg from the one list of parameters; cfg_test compares.\n"
      "from dynamic_reconfigure.parameter_generator_catkin import ParameterGenerator, bool_t, double_t, int_t\n\n"
      "gen = ParameterGenerator()\n";
  std::string stage;
  for (const ParamRef& ref : liveParamList(settings)) {
    const std::string of = ref.key.substr(0, ref.key.find('.'));
    if (of != stage) file += "\ngroup = gen.add_group(" + quoted(of) + ")\n";
    stage = of;
    file += parameterLines(ref);
  }
  return file + "\nexit(gen.generate(\"fdp_stereo\", \"disparity\", \"Disparity\"))\n";
}

}  // namespace fdp_stereo
