// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params_ros.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "fdp_stereo/unknown_parameters.hpp"

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
  const std::string text = describeUnknown(refs, names);
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

}  // namespace

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

}  // namespace fdp_stereo
