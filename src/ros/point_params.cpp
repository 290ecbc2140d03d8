// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_params.hpp"

#include <algorithm>
#include <vector>

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

}  // namespace

PointsNodeParams readPointsNodeParams(const ros::NodeHandle& private_node, const Warn& warn) {
  PointsNodeParams params;
  Reader reader(private_node, warn);
  reader.read("points_decimation", 1, 64, params.points.decimation);
  reader.read("min_confidence", 0.0, 1.0, params.points.min_confidence);
  reader.read("max_depth_error", 0.0, 1000.0, params.points.max_depth_error);
  reader.read("max_depth", 0.0, 10000.0, params.points.max_depth);
  reader.read("scan_frame", params.scan_frame);
  reader.read("scan_min_height", -1000.0, 1000.0, params.scan.min_height_m);
  reader.read("scan_max_height", -1000.0, 1000.0, params.scan.max_height_m);
  reader.read("scan_range_min", 0.0, 1000.0, params.scan.min_range_m);
  reader.read("scan_range_max", 0.01, 1000.0, params.scan.max_range_m);
  reader.read("scan_angle_increment", 0.0005, 0.5, params.scan.increment_rad);
  reader.read("queue_size", 1, 1000, params.queue_size);
  reader.read("diagnostic_period", 0.02, 3600.0, params.diagnostic_period_s);
  const RangeScanParams defaults;
  checkOrder({"scan_min_height", params.scan.min_height_m, defaults.min_height_m},
             {"scan_max_height", params.scan.max_height_m, defaults.max_height_m}, warn);
  checkOrder({"scan_range_min", params.scan.min_range_m, defaults.min_range_m},
             {"scan_range_max", params.scan.max_range_m, defaults.max_range_m}, warn);
  reader.warnOfUnknown();
  return params;
}

}  // namespace fdp_stereo
