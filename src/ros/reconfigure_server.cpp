// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reconfigure_server.hpp"

#include <algorithm>
#include <utility>

#include <dynamic_reconfigure/ConfigDescription.h>
#include <fdp_stereo/DisparityConfig.h>

namespace fdp_stereo {
namespace {

/// Names, groups and flags as the tools of dynamic_reconfigure expect them, with the values of `settings`.
dynamic_reconfigure::Config completeConfig(const NodeSettings& settings) {
  dynamic_reconfigure::Config config;
  DisparityConfig::__getDefault__().__toMessage__(config);
  toConfig(settings, config);
  return config;
}

/// True where `name` has another value in `known`, or none.
template <typename Entries>
bool isNew(const Entries& known, const typename Entries::value_type& entry) {
  return std::none_of(known.begin(), known.end(),
                      [&](const auto& k) { return k.name == entry.name && k.value == entry.value; });
}

}  // namespace

ReconfigureServer::ReconfigureServer(const ros::NodeHandle& private_node, const std::vector<std::string>& others,
                                     Report report)
    : node_(private_node), report_(std::move(report)) {
  description_ = node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = node_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
  adopt(loadInitial(others));
  publishDescription();
  service_ = node_.advertiseService("set_parameters", &ReconfigureServer::onSetParameters, this);
}

std::shared_ptr<const NodeSettings> ReconfigureServer::settings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return settings_;
}

NodeSettings ReconfigureServer::loadInitial(const std::vector<std::string>& others) {
  NodeSettings settings;
  const std::string preset = node_.param<std::string>("preset", kDefaultPreset);
  try {
    settings.pipeline = loadPreset(preset);
  } catch (const std::exception& error) {
    report_("~preset: " + std::string(error.what()) + "; using " + kDefaultPreset);
    settings.pipeline = loadPreset(kDefaultPreset);
  }
  XmlRpc::XmlRpcValue values;
  if (!node_.getParam("", values)) return settings;
  std::vector<std::string> messages;
  settings = applyRosparam(values, settings, others, messages);
  for (const std::string& message : messages) report_(message);
  settings.revision = 0;
  return settings;
}

bool ReconfigureServer::onSetParameters(dynamic_reconfigure::Reconfigure::Request& request,
                                        dynamic_reconfigure::Reconfigure::Response& response) {
  std::vector<std::string> messages;
  const NodeSettings edited = applyConfig(request.config, *settings(), messages);
  for (const std::string& message : messages) report_(message);
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
  written_ = values;
}

void ReconfigureServer::publishDescription() {
  auto description = DisparityConfig::__getDescriptionMessage__();
  description.dflt = completeConfig(*settings());
  description_.publish(description);
}

}  // namespace fdp_stereo
