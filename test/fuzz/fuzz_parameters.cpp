// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Parameter sets from reconfigure messages, the parameter server and YAML: always a valid set, or an exception from
// YAML.
#include <cstdlib>
#include <stdexcept>

#include <dynamic_reconfigure/config_tools.h>
#include <fdp_stereo/PointsConfig.h>

#include "fuzz_input.hpp"
#include "params_ros.hpp"
#include "point_params.hpp"

namespace fdp_stereo::fuzz {
namespace {

using dynamic_reconfigure::ConfigTools;

std::string takeName(Input& input, const std::vector<ParamRef>& refs) {
  const auto which = input.take<std::uint8_t>();
  return which < 250 ? refs[which % refs.size()].ros_name : input.takeText(40);
}

void fuzzConfig(Input& input) {
  NodeSettings settings;
  const auto refs = liveParamList(settings);
  std::vector<std::string> messages;
  for (int edit = 0; edit < 3 && input.left() > 0; ++edit) {
    dynamic_reconfigure::Config config;
    for (int i = 0; i < 4; ++i) {
      ConfigTools::appendParameter(config, takeName(input, refs), input.take<double>());
      ConfigTools::appendParameter(config, takeName(input, refs), input.take<int>());
      ConfigTools::appendParameter(config, takeName(input, refs), input.take<std::uint8_t>() % 2 == 0);
    }
    settings = applyConfig(config, settings, messages);
    validate(settings);  // throws where a bad set got through: a finding
  }
}

/// As dynamic_reconfigure's server does it.
void fuzzPointsConfig(Input& input) {
  PointsNodeParams params;
  PointsConfig config = liveConfig(params);
  for (int edit = 0; edit < 3 && input.left() > 0; ++edit) {
    for (double PointsConfig::*member :
         {&PointsConfig::min_confidence, &PointsConfig::max_depth_error, &PointsConfig::max_depth,
          &PointsConfig::scan_min_height, &PointsConfig::scan_max_height, &PointsConfig::scan_range_min,
          &PointsConfig::scan_range_max, &PointsConfig::scan_angle_increment}) {
      config.*member = input.take<double>();
    }
    config.points_decimation = input.take<int>();
    config.__clamp__();
    applyLive(config, params, [](const std::string&) {});
    const RangeScanParams& scan = params.scan;
    const bool valid = scan.min_height_m < scan.max_height_m && scan.min_range_m < scan.max_range_m &&
                       scan.increment_rad > 0.0 && params.points.decimation >= 1 && params.points.max_depth >= 0.0 &&
                       params.points.max_depth_error >= 0.0 && params.points.min_confidence >= 0.0;
    if (!valid) std::abort();
  }
}

void fuzzRosparam(Input& input) {
  NodeSettings settings;
  const auto refs = liveParamList(settings);
  XmlRpc::XmlRpcValue values;
  values["anything"] = 1;
  for (int i = 0; i < 8 && input.left() > 0; ++i) {
    XmlRpc::XmlRpcValue value;
    switch (input.take<std::uint8_t>() % 5) {
      case 0:
        value = input.take<int>();
        break;
      case 1:
        value = input.take<double>();
        break;
      case 2:
        value = input.takeText(20);
        break;
      case 3:
        value = input.take<std::uint8_t>() % 2 == 0;
        break;
      default:
        value[input.takeText(10)] = input.takeText(10);
        break;
    }
    values[takeName(input, refs)] = value;
  }
  std::vector<std::string> messages;
  validate(applyRosparam(values, settings, {}, messages));
}

void fuzzYaml(Input& input) {
  const auto bytes = input.takeBytes(4096);
  PipelineParams params;
  try {
    loadYaml(params, std::string(bytes.begin(), bytes.end()), "fuzz");
  } catch (const std::invalid_argument&) {
    return;
  }
  PipelineParams again;
  loadYaml(again, toYaml(params), "dump");  // what was read can be written and read
  if (toYaml(again) != toYaml(params)) std::abort();
}

}  // namespace
}  // namespace fdp_stereo::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fdp_stereo::fuzz::Input input(data, size);
  const auto kind = input.take<std::uint8_t>();
  if (kind / 16 == 14) {
    fdp_stereo::fuzz::fuzzPointsConfig(input);
  } else if (kind % 3 == 0) {
    fdp_stereo::fuzz::fuzzConfig(input);
  } else if (kind % 3 == 1) {
    fdp_stereo::fuzz::fuzzRosparam(input);
  } else {
    fdp_stereo::fuzz::fuzzYaml(input);
  }
  return 0;
}
