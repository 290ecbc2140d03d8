// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params/parameter_text.hpp"

#include "fdp_stereo/unknown_parameters.hpp"

#include <algorithm>
#include <charconv>
#include <locale>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace fdp_stereo {
namespace {

template <typename... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <typename... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;

std::string printNumber(double value, int digits) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(digits);
  out << value;
  return out.str();
}

std::string allowed(const ParamRef& ref) {
  if (std::holds_alternative<bool*>(ref.value)) return "true or false";
  if (const auto* choice = std::get_if<EnumRef>(&ref.value)) return "one of " + join(choice->names);
  const std::string kind = std::holds_alternative<int*>(ref.value) ? "an integer" : "a number";
  return kind + " from " + formatNumber(ref.min) + " to " + formatNumber(ref.max) +
         (ref.unit.empty() ? "" : " " + ref.unit);
}

bool parse(const std::string& text, bool& value) {
  value = text == "true" || text == "1" || text == "on" || text == "yes";
  return value || text == "false" || text == "0" || text == "off" || text == "no";
}

bool parse(const std::string& text, int& value) {
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

bool parse(const std::string& text, double& value) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  return !text.empty() && in >> std::noskipws >> value && in.peek() == std::istringstream::traits_type::eof();
}

/// The index of a choice that is given by its name, or by its number as dynamic_reconfigure does.
int parseChoice(const ParamRef& ref, const EnumRef& choice, const std::string& text) {
  const auto found = std::find(choice.names.begin(), choice.names.end(), text);
  if (found != choice.names.end()) return static_cast<int>(found - choice.names.begin());
  int index = 0;
  if (!parse(text, index) || !inRange(ref, index)) reject(ref, text);
  return index;
}

int editDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

std::string nearestName(const std::vector<ParamRef>& refs, const std::string& name) {
  const ParamRef* nearest = nullptr;
  int least = 0;
  bool by_key = true;
  for (const ParamRef& ref : refs) {
    const int key = editDistance(ref.key, name);
    const int ros_name = editDistance(ref.ros_name, name);
    if (nearest != nullptr && std::min(key, ros_name) >= least) continue;
    nearest = &ref;
    least = std::min(key, ros_name);
    by_key = key <= ros_name;
  }
  return by_key ? nearest->key : nearest->ros_name;
}

/// What does the work here of a parameter of stereo_image_proc that has another name or meaning.
struct Successor {
  const char* old_name;
  const char* advice;
};
constexpr Successor kSuccessors[] = {
    {"P1", "use semi_global_p1, in other units"},
    {"P2", "use semi_global_p2, in other units"},
    {"correlation_window_size", "use matching_cost_census_width and matching_cost_census_height"},
    {"stereo_algorithm", "use optimizer_type"},
    {"fullDP", "not needed here"},
    {"prefilter_size", "not needed here"},
    {"prefilter_cap", "not needed here"},
    {"texture_threshold", "not needed here"},
    {"sgbm_mode", "not needed here"},
    {"disp12_max_diff", "use disp12MaxDiff"},
    {"downsampling_factor", "use pipeline_scale, 0.5 for 2"},
    {"approximate_sync_tolerance_seconds", "use approximate_sync_tolerance"},
    {"use_system_default_qos", "not needed here"},
    {"use_color", "use color:=true of stereo.launch"},
    {"avoid_point_cloud_padding", "not needed here"},
    {"use_image_transport_camera_info", "not needed here"},
};
constexpr char kMigration[] = "; docs/migration.md goes through the parameters of stereo_image_proc";

const Successor* findSuccessor(const std::string& old_name) {
  const auto* found = std::find_if(std::begin(kSuccessors), std::end(kSuccessors),
                                   [&](const Successor& successor) { return old_name == successor.old_name; });
  return found == std::end(kSuccessors) ? nullptr : found;
}

std::string trim(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::string formatNumber(double value) {
  for (int digits = 6; digits < 17; ++digits) {
    std::string text = printNumber(value, digits);
    double back = 0.0;
    if (parse(text, back) && back == value) return text;
  }
  return printNumber(value, 17);
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool inRange(const ParamRef& ref, double value) { return value >= ref.min && value <= ref.max; }

void reject(const ParamRef& ref, const std::string& value) {
  throw std::invalid_argument(ref.key + " = '" + value + "': must be " + allowed(ref));
}

const ParamRef* findParam(const std::vector<ParamRef>& refs, const std::string& name) {
  const auto found = std::find_if(refs.begin(), refs.end(),
                                  [&](const ParamRef& ref) { return ref.key == name || ref.ros_name == name; });
  return found == refs.end() ? nullptr : &*found;
}

std::string adviceFor(const std::vector<ParamRef>& refs, const std::string& unknown) {
  if (const Successor* successor = findSuccessor(unknown)) return successor->advice;
  return "did you mean '" + nearestName(refs, unknown) + "'?";
}

std::string describeUnknown(const std::vector<ParamRef>& refs, const std::vector<std::string>& names) {
  std::string text;
  bool migrates = false;
  for (const std::string& name : names) {
    text += (text.empty() ? "'" : ", '") + name + "' (" + adviceFor(refs, name) + ")";
    migrates = migrates || findSuccessor(name) != nullptr;
  }
  return migrates ? text + kMigration : text;
}

const ParamRef& requireParam(const std::vector<ParamRef>& refs, const std::string& name) {
  const ParamRef* ref = findParam(refs, name);
  if (ref == nullptr) throw std::invalid_argument("unknown parameter '" + name + "', " + adviceFor(refs, name));
  return *ref;
}

bool isWhole(const ParamRef& ref) { return !std::holds_alternative<double*>(ref.value); }

double toNumber(const ParamRef& ref) {
  return std::visit(Overloaded{[](const EnumRef& choice) { return static_cast<double>(choice.get()); },
                               [](const auto* value) { return static_cast<double>(*value); }},
                    ref.value);
}

void setFromNumber(const ParamRef& ref, double number) {
  std::visit(
      Overloaded{[&](const EnumRef& choice) { choice.set(static_cast<int>(number)); },
                 [&](bool* value) { *value = number != 0.0; }, [&](int* value) { *value = static_cast<int>(number); },
                 [&](double* value) { *value = number; }},
      ref.value);
}

std::string toString(const ParamRef& ref) {
  return std::visit(Overloaded{[](const bool* value) { return std::string(*value ? "true" : "false"); },
                               [](const int* value) { return std::to_string(*value); },
                               [](const double* value) { return formatNumber(*value); },
                               [](const EnumRef& choice) { return choice.names.at(choice.get()); }},
                    ref.value);
}

void setFromString(const ParamRef& ref, const std::string& text) {
  const auto setNumber = [&](auto* target) {
    auto value = *target;
    if (!parse(text, value)) reject(ref, text);
    if (!inRange(ref, static_cast<double>(value))) reject(ref, text);
    *target = value;
  };
  const auto setChoice = [&](const EnumRef& choice) { choice.set(parseChoice(ref, choice, text)); };
  std::visit(Overloaded{[&](auto* target) { setNumber(target); }, setChoice}, ref.value);
}

void setParam(PipelineParams& params, const std::string& name, const std::string& text) {
  setFromString(requireParam(paramList(params), name), text);
}

void setParam(PipelineParams& params, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) throw std::invalid_argument("'" + assignment + "': must be stage.name=value");
  setParam(params, trim(assignment.substr(0, equals)), trim(assignment.substr(equals + 1)));
}

}  // namespace fdp_stereo
