// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_params.hpp"

#include <algorithm>
#include <vector>

#include <fdp_stereo/PointsConfig.h>

#include "text.hpp"

namespace fdp_stereo {
namespace {

using Warn = std::function<void(const std::string&)>;

class Reader {
 public:
  Reader(const ros::NodeHandle& node, const Warn& warn) : node_(node), warn_(warn) {}

  template <typename Value>
  void read(const std::string& name, Value min, Value max, Value& value) {
    names_.push_back(name);
    XmlRpc::XmlRpcValue given;
    if (!node_.getParam(name, given)) return;
    double number = 0.0;
    if (given.getType() == XmlRpc::XmlRpcValue::TypeInt) {
      number = static_cast<int>(given);
    } else if (given.getType() == XmlRpc::XmlRpcValue::TypeDouble) {
      number = static_cast<double>(given);
    } else {
      return warn_(text("~", name, " is no number; using ", value));
    }
    if (!(number >= min && number <= max)) {
      return warn_(text("~", name, " = ", number, " must be ", min, " to ", max, "; using ", value));
    }
    value = static_cast<Value>(number);
  }

  void read(const std::string& name, std::string& value) {
    names_.push_back(name);
    if (node_.hasParam(name) && (!node_.getParam(name, value) || value.empty())) {
      warn_(text("~", name, " is no text, or empty; using base_link"));
      value = "base_link";
    }
  }

  void warnOfUnknown() const {
    std::vector<std::string> all;
    node_.getParamNames(all);
    const std::string prefix = node_.getNamespace() + "/";
    for (const std::string& full : all) {
      if (full.compare(0, prefix.size(), prefix) != 0) continue;
      const std::string name = full.substr(prefix.size());
      const bool known = name == "image_transport" || std::find(names_.begin(), names_.end(), name) != names_.end();
      if (!known) warn_(text("~", name, " is no parameter of this node; docs/points.md lists them"));
    }
  }

 private:
  const ros::NodeHandle& node_;
  const Warn& warn_;
  std::vector<std::string> names_;
};

struct Limit {
  const char* name;
  double& value;
  double fallback;
};

void checkOrder(const Limit& low, const Limit& high, const Warn& warn) {
  if (low.value < high.value) return;
  warn(text("~", low.name, " = ", low.value, " must be below ~", high.name, " = ", high.value, "; using ", low.fallback,
            " and ", high.fallback));
  low.value = low.fallback;
  high.value = high.fallback;
}

void checkOrders(RangeScanParams& scan, const Warn& warn) {
  const RangeScanParams defaults;
  checkOrder({"scan_min_height", scan.min_height_m, defaults.min_height_m},
             {"scan_max_height", scan.max_height_m, defaults.max_height_m}, warn);
  checkOrder({"scan_range_min", scan.min_range_m, defaults.min_range_m},
             {"scan_range_max", scan.max_range_m, defaults.max_range_m}, warn);
}

/// Calls visit(name, member of PointsConfig, value in `params`) for each parameter that can be changed live.
template <typename Visit>
void forEachLive(PointsNodeParams& params, Visit&& visit) {
  using Config = PointsConfig;
  visit("points_decimation", &Config::points_decimation, params.points.decimation);
  visit("min_confidence", &Config::min_confidence, params.points.min_confidence);
  visit("max_depth_error", &Config::max_depth_error, params.points.max_depth_error);
  visit("max_depth", &Config::max_depth, params.points.max_depth);
  visit("scan_min_height", &Config::scan_min_height, params.scan.min_height_m);
  visit("scan_max_height", &Config::scan_max_height, params.scan.max_height_m);
  visit("scan_range_min", &Config::scan_range_min, params.scan.min_range_m);
  visit("scan_range_max", &Config::scan_range_max, params.scan.max_range_m);
  visit("scan_angle_increment", &Config::scan_angle_increment, params.scan.increment_rad);
}

}  // namespace

PointsNodeParams readPointsNodeParams(const ros::NodeHandle& private_node, const Warn& warn) {
  PointsNodeParams params;
  Reader reader(private_node, warn);
  const PointsConfig min = PointsConfig::__getMin__();
  const PointsConfig max = PointsConfig::__getMax__();
  forEachLive(params,
              [&](const char* name, auto member, auto& value) { reader.read(name, min.*member, max.*member, value); });
  reader.read("scan_frame", params.scan_frame);
  reader.read("queue_size", 1, 1000, params.queue_size);
  reader.read("diagnostic_period", 0.02, 3600.0, params.diagnostic_period_s);
  checkOrders(params.scan, warn);
  reader.warnOfUnknown();
  return params;
}

PointsConfig liveConfig(PointsNodeParams params) {
  PointsConfig config = PointsConfig::__getDefault__();
  forEachLive(params, [&](const char*, auto member, auto& value) { config.*member = value; });
  return config;
}

void applyLive(PointsConfig& config, PointsNodeParams& params, const Warn& warn) {
  forEachLive(params, [&](const char* name, auto member, auto& value) {
    if (config.*member == config.*member) {
      value = config.*member;
    } else {
      warn(text("~", name, " = nan is no number; it stays ", value));
    }
  });
  checkOrders(params.scan, warn);
  config = liveConfig(params);
}

}  // namespace fdp_stereo
