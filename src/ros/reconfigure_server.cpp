// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reconfigure_server.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include <dynamic_reconfigure/ConfigDescription.h>
#include <fdp_stereo/DisparityConfig.h>
#include <ros/service_manager.h>

namespace fdp_stereo {
namespace {

/// True where `name` has another value in `known`, or none.
template <typename Entries>
bool isNew(const Entries& known, const typename Entries::value_type& entry) {
  return std::none_of(known.begin(), known.end(),
                      [&](const auto& k) { return k.name == entry.name && k.value == entry.value; });
}

/// The numbers, flags and words of a namespace of the parameter server.
dynamic_reconfigure::Config storedConfig(const XmlRpc::XmlRpcValue& const_values) {
  dynamic_reconfigure::Config config;
  XmlRpc::XmlRpcValue values = const_values;  // its conversions are not const
  if (values.getType() != XmlRpc::XmlRpcValue::TypeStruct) return config;
  const auto append = [](auto& entries, const std::string& name, auto value) {
    entries.emplace_back();
    entries.back().name = name;
    entries.back().value = value;
  };
  for (auto& [name, value] : values) {
    const auto type = value.getType();
    if (type == XmlRpc::XmlRpcValue::TypeBoolean) append(config.bools, name, static_cast<bool>(value));
    if (type == XmlRpc::XmlRpcValue::TypeInt) append(config.ints, name, static_cast<int>(value));
    if (type == XmlRpc::XmlRpcValue::TypeDouble) append(config.doubles, name, static_cast<double>(value));
    if (type == XmlRpc::XmlRpcValue::TypeString) append(config.strs, name, static_cast<std::string>(value));
  }
  return config;
}

/// Where a file with a relative name was looked for: roslaunch starts nodes in a folder of its own.
std::string lookedIn(const std::string& preset) {
  const std::filesystem::path path(preset);
  if (path.is_absolute() || path.extension().empty()) return "";
  std::error_code ignored;
  return " (looked in " + std::filesystem::current_path(ignored).string() + "; give the whole path)";
}

/// A nodelet that is unloaded while one of its callbacks runs ends in the thread of that callback, later than the
/// answer to the unloading; one that is loaded again at once must wait for the name of its service.
void waitForPredecessor(const std::string& service) {
  constexpr auto kPatience = std::chrono::seconds(5);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (ros::ServiceManager::instance()->lookupServicePublication(service) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

std::vector<dynamic_reconfigure::GroupState> initialGroups() {
  // The defaults of the generated class have every group open; their states are set by the descriptions alone.
  DisparityConfig config = DisparityConfig::__getDefault__();
  for (const auto& group : DisparityConfig::__getGroupDescriptions__()) {
    boost::any top = &config;
    if (group->id == 0) group->setInitialState(top);
  }
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  return message.groups;
}

ReconfigureServer::ReconfigureServer(const ros::NodeHandle& private_node, const std::vector<std::string>& others,
                                     Report report)
    : node_(private_node), report_(std::move(report)), groups_(initialGroups()) {
  description_ = node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = node_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
  adopt(loadInitial(others));
  publishDescription();
  waitForPredecessor(node_.resolveName("set_parameters"));
  service_ = node_.advertiseService("set_parameters", &ReconfigureServer::onSetParameters, this);
}

std::shared_ptr<const NodeSettings> ReconfigureServer::settings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return settings_;
}

NodeSettings ReconfigureServer::loadInitial(const std::vector<std::string>& others) {
  NodeSettings settings;
  std::vector<std::string> messages;
  std::vector<std::string> known = others;
  known.insert(known.end(), {"preset", "params"});
  const std::string preset = node_.param<std::string>("preset", kDefaultPreset);
  try {
    if (preset != kCustomPreset) settings.pipeline = loadPreset(preset);
    if (preset != kCustomPreset && !isPreset(preset))
      settings = applyYaml(readYamlFile(preset), settings, known, messages);
  } catch (const std::exception& error) {
    report_("~preset: " + std::string(error.what()) + lookedIn(preset) + "; using " + kDefaultPreset);
    settings = {};
  }
  try {
    const std::vector<NamedText> params = readYaml(node_.param<std::string>("params", ""), "~params");
    settings = applyYaml(params, settings, known, messages);
  } catch (const std::exception& error) {
    report_(std::string(error.what()) + "; ~params has no effect");
  }
  XmlRpc::XmlRpcValue values;
  if (node_.getParam("", values)) {
    written_ = storedConfig(values);
    settings = applyRosparam(values, settings, known, messages);
  }
  for (const std::string& message : messages) report_(message);
  settings.revision = 0;
  return settings;
}

dynamic_reconfigure::Config ReconfigureServer::completeConfig(const NodeSettings& settings) const {
  dynamic_reconfigure::Config config;
  toConfig(settings, config);
  config.groups = groups_;
  return config;
}

void ReconfigureServer::apply(const dynamic_reconfigure::Config& edits) {
  std::vector<std::string> messages;
  {
    const std::lock_guard<std::mutex> lock(edit_mutex_);
    adopt(applyConfig(edits, *settings(), messages));
  }
  for (const std::string& message : messages) report_(message);
}

bool ReconfigureServer::onSetParameters(dynamic_reconfigure::Reconfigure::Request& request,
                                        dynamic_reconfigure::Reconfigure::Response& response) {
  const std::lock_guard<std::mutex> lock(edit_mutex_);
  std::vector<std::string> messages;
  const NodeSettings edited = applyConfig(request.config, *settings(), messages);
  for (const std::string& message : messages) report_(message);
  for (const auto& wanted : request.config.groups) {
    for (auto& group : groups_) {
      if (group.name == wanted.name) group.state = wanted.state;
    }
  }
  adopt(edited);
  response.config = completeConfig(edited);
  return true;
}

void ReconfigureServer::adopt(const NodeSettings& settings) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    settings_ = std::make_shared<const NodeSettings>(settings);
  }
  const auto config = completeConfig(settings);
  writeBack(config);
  updates_.publish(config);
}

void ReconfigureServer::writeBack(const dynamic_reconfigure::Config& values) {
  for (const auto& entry : values.bools) {
    if (isNew(written_.bools, entry)) node_.setParam(entry.name, entry.value != 0);
  }
  for (const auto& entry : values.ints) {
    if (isNew(written_.ints, entry)) node_.setParam(entry.name, entry.value);
  }
  for (const auto& entry : values.doubles) {
    if (isNew(written_.doubles, entry)) node_.setParam(entry.name, entry.value);
  }
  for (const auto& entry : values.strs) {  // "custom" would hide the name of a file
    if (entry.value != kCustomPreset && isNew(written_.strs, entry)) node_.setParam(entry.name, entry.value);
  }
  written_ = values;
}

void ReconfigureServer::publishDescription() {
  auto description = DisparityConfig::__getDescriptionMessage__();
  description.dflt = completeConfig(*settings());
  description_.publish(description);
}

}  // namespace fdp_stereo
