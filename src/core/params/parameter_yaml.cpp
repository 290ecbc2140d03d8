// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include "fdp_stereo/unknown_parameters.hpp"
#include "params/parameter_text.hpp"
#include "params/presets.hpp"

namespace fdp_stereo {
namespace {

constexpr std::size_t kMaxYamlBytes = 1U << 20;
constexpr int kMaxYamlDepth = 4;

[[noreturn]] void fail(const std::string& file, int line, const std::string& problem) {
  throw std::invalid_argument(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + problem);
}

int lineOf(const YAML::Node& node) { return node.Mark().line + 1; }

/// Walks nested maps; dotted keys and nesting may be mixed.
class YamlReader {
 public:
  explicit YamlReader(std::string name) : name_(std::move(name)) {}

  std::vector<NamedText> read(const YAML::Node& root) {
    if (!root.IsNull()) readMap(root.IsMap() && root["dictitems"] ? root["dictitems"] : root, "", 0);
    return std::move(values_);
  }

 private:
  void readMap(const YAML::Node& node, const std::string& prefix, int depth) {
    const std::string at = prefix.empty() ? "" : prefix + " ";
    if (!node.IsMap() || depth > kMaxYamlDepth) fail(name_, lineOf(node), at + "must be a map of parameters");
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) fail(name_, lineOf(entry.first), at + "a key must be a word");
      const std::string key = prefix.empty() ? entry.first.Scalar() : prefix + "." + entry.first.Scalar();
      if (key == "groups" || key == "state") continue;  // how dynparam's dump remembers the window of rqt
      if (entry.second.IsScalar()) {
        values_.push_back({key, entry.second.Scalar(), lineOf(entry.second)});
      } else {
        readMap(entry.second, key, depth + 1);
      }
    }
  }

  std::string name_;
  std::vector<NamedText> values_;
};

/// What a dump of a node, or a file for one, holds beside the pipeline's parameters.
bool belongsToTheNode(const std::string& name) {
  static const std::set<std::string> names = {
      "preset", "params",
      // read at the start
      "approximate_sync", "approximate_sync_tolerance", "diagnostic_period", "image_transport", "left_mask", "nearest",
      "queue_size", "rectify", "right_mask", "seeds_fixed_frame", "watch_period",
      // live
      "deadline_ms", "max_age", "max_depth", "max_depth_error", "max_rate", "min_confidence", "min_depth", "nice",
      "seeds_depth_trust", "seeds_disparity_trust", "seeds_max_age", "seeds_points_trust", "seeds_spacing",
      "seeds_wait",
      // the same by their keys
      "node.deadline_ms", "node.max_age_s", "node.max_depth_error_m", "node.max_depth_m", "node.max_rate_hz",
      "node.min_confidence", "node.min_depth_m", "node.nice", "seeds.depth_trust", "seeds.disparity_trust",
      "seeds.max_age_s", "seeds.points_trust", "seeds.spacing_px", "seeds.wait_s"};
  return names.count(name) != 0;
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxYamlBytes + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || !(file || file.eof())) throw std::invalid_argument(path + ": cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

const Preset* findPreset(const std::string& name) {
  const std::vector<Preset>& presets = builtInPresets();
  const auto found = std::find_if(presets.begin(), presets.end(), [&](const Preset& p) { return p.name == name; });
  return found == presets.end() ? nullptr : &*found;
}

/// One error for all of them.
void refuseUnknown(const std::vector<ParamRef>& refs, const std::vector<NamedText>& values, const std::string& file) {
  std::vector<std::string> names;
  int first_line = 0;
  for (const NamedText& value : values) {
    if (belongsToTheNode(value.name) || findParam(refs, value.name) != nullptr) continue;
    if (names.empty()) first_line = value.line;
    names.push_back(value.name);
  }
  if (!names.empty()) {
    fail(file, first_line,
         "unknown parameter" + std::string(names.size() > 1 ? "s " : " ") + describeUnknown(refs, names));
  }
}

void loadValues(PipelineParams& params, const std::vector<NamedText>& values, const std::string& file) {
  for (const NamedText& value : values) {
    if (value.name == "preset" && isPreset(value.text)) usePreset(params, value.text);
  }
  const std::vector<ParamRef> refs = paramList(params);
  refuseUnknown(refs, values, file);
  std::set<std::string> seen;
  for (const NamedText& value : values) {
    if (belongsToTheNode(value.name)) continue;
    try {
      const ParamRef& ref = *findParam(refs, value.name);
      if (!seen.insert(ref.key).second) throw std::invalid_argument(value.name + " is given twice");
      setFromString(ref, value.text);
    } catch (const std::invalid_argument& error) {
      fail(file, value.line, error.what());
    }
  }
}

}  // namespace

std::vector<NamedText> readYaml(const std::string& text, const std::string& name) {
  if (text.size() > kMaxYamlBytes) throw std::invalid_argument(name + ": more than 1 MB cannot be parameters");
  try {
    return YamlReader(name).read(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    fail(name, error.mark.line + 1, error.msg);
  }
}

std::vector<NamedText> readYamlFile(const std::string& path) { return readYaml(readText(path), path); }

void loadYaml(PipelineParams& params, const std::string& text, const std::string& name) {
  PipelineParams loaded = params;
  loadValues(loaded, readYaml(text, name), name);
  params = loaded;
}

std::string toYaml(const PipelineParams& params) {
  PipelineParams copy = params;
  std::string yaml;
  std::string stage;
  for (const ParamRef& ref : paramList(copy)) {
    const std::size_t dot = ref.key.find('.');
    if (ref.key.substr(0, dot) != stage) {
      stage = ref.key.substr(0, dot);
      yaml += stage + ":\n";
    }
    yaml += "  " + ref.key.substr(dot + 1) + ": " + toString(ref) + "\n";
  }
  return yaml;
}

std::vector<std::string> presetNames() {
  std::vector<std::string> names;
  for (const Preset& preset : builtInPresets()) names.push_back(preset.name);
  return names;
}

bool isPreset(const std::string& name) { return findPreset(name) != nullptr; }

PipelineParams loadPreset(const std::string& name_or_file) {
  PipelineParams params;
  if (const Preset* preset = findPreset(name_or_file)) {
    loadYaml(params, preset->yaml, "preset " + preset->name);
    return params;
  }
  if (name_or_file.find_first_of("/.") == std::string::npos) {
    throw std::invalid_argument("unknown preset '" + name_or_file + "': there are " + join(presetNames()) +
                                ", or give a YAML file");
  }
  loadValues(params, readYamlFile(name_or_file), name_or_file);
  return params;
}

void usePreset(PipelineParams& params, const std::string& name) {
  PipelineParams loaded = loadPreset(name);
  loaded.search = params.search;
  loaded.threads = params.threads;
  loaded.scale = params.scale;
  loaded.max_memory_mb = params.max_memory_mb;
  params = loaded;
}

}  // namespace fdp_stereo
