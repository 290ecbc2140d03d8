// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include <ros/node_handle.h>

#include "point_messages.hpp"

namespace fdp_stereo {

class PointsConfig;

/// Private parameters of the nodelet fdp_stereo/points.
struct PointsNodeParams {
  PointParams points;
  RangeScanParams scan;
  std::string scan_frame = "base_link";
  int queue_size = 60;  ///< frames that wait for their parts
  double diagnostic_period_s = 1.0;
};

/// `warn` gets a line per value that is not possible, which is replaced by its default, and per unknown name.
PointsNodeParams readPointsNodeParams(const ros::NodeHandle& private_node,
                                      const std::function<void(const std::string&)>& warn);

/// Those that can be changed live, as dynamic_reconfigure has them.
PointsConfig liveConfig(PointsNodeParams params);

/// Takes them over; what does not go together is replaced, in `config` too, and told to `warn`.
void applyLive(PointsConfig& config, PointsNodeParams& params, const std::function<void(const std::string&)>& warn);

}  // namespace fdp_stereo
