// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <ros/node_handle.h>

#include "fdp_stereo/pipeline_params.hpp"
#include "text.hpp"

namespace fdp_stereo {

/// Private parameters that are read once, at the start; those that are not set come from the YAML text `~params`, if
/// it has them. Remembers their names, so that whoever judges the others knows them.
class StartParams {
 public:
  using Warn = std::function<void(const std::string&)>;
  StartParams(const ros::NodeHandle& private_node, Warn warn) : node_(private_node), warn_(std::move(warn)) {
    try {
      given_ = readYaml(node_.param<std::string>("params", ""), "~params");
    } catch (const std::invalid_argument&) {  // which ReconfigureServer reports
    }
  }

  template <typename Value>
  Value param(const std::string& name, const Value& fallback) {
    names_.push_back(name);
    for (const NamedText& given : given_) {
      if (given.name == name && !node_.hasParam(name)) set<Value>(given);
    }
    Value value = fallback;
    if (node_.hasParam(name) && !node_.getParam(name, value)) {
      warn_(text("~", name, " is no ", kind<Value>(), "; using '", fallback, "'"));
      return fallback;
    }
    return value;
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  template <typename Value>
  void set(const NamedText& given) {
    if constexpr (std::is_same_v<Value, std::string>) {
      node_.setParam(given.name, given.text);
    } else {
      std::istringstream in(given.text);
      in.imbue(std::locale::classic());
      Value value{};
      if (in >> std::boolalpha >> value) node_.setParam(given.name, value);
    }
  }

  template <typename Value>
  static const char* kind() {
    if (std::is_same_v<Value, std::string>) return "text";
    return std::is_same_v<Value, bool> ? "true or false" : "number";
  }

  ros::NodeHandle node_;
  Warn warn_;
  std::vector<NamedText> given_;
  std::vector<std::string> names_;
};

}  // namespace fdp_stereo
