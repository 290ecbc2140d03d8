// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/config_tools.h>
#include <geometry_msgs/TransformStamped.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "nodelet_graph.hpp"
#include "point_scene.hpp"

namespace fdp_stereo::test {

/// The nodelet fdp_stereo/points inside the test process.
class PointsNodeletHost {
 public:
  explicit PointsNodeletHost(const std::string& name, const std::map<std::string, XmlRpc::XmlRpcValue>& params = {})
      : name_(name + "/points_nodelet"), loader_(false) {
    ros::param::del(name_);
    ros::param::set(name_ + "/diagnostic_period", 0.05);
    for (const auto& [key, value] : params) ros::param::set(name_ + "/" + key, value);
    loaded_ = loader_.load(name_, "fdp_stereo/points", {}, {});
  }
  ~PointsNodeletHost() { loader_.unload(name_); }
  bool loaded() const { return loaded_; }
  /// A live edit; the value that holds then. Fails the test where the service does not answer.
  template <typename Value>
  Value edit(const std::string& name, Value value) {
    dynamic_reconfigure::Reconfigure call;
    dynamic_reconfigure::ConfigTools::appendParameter(call.request.config, name, value);
    EXPECT_TRUE(ros::service::call(name_ + "/set_parameters", call));
    dynamic_reconfigure::ConfigTools::getParameter(call.response.config, name, value);
    return value;
  }

 private:
  std::string name_;
  nodelet::Loader loader_;
  bool loaded_ = false;
};

/// tf from left_optical to base_link.
class CameraOnBase {
 public:
  CameraOnBase() {
    const Eigen::Isometry3d place = baseFromCamera();
    const Eigen::Quaterniond q(place.linear());
    geometry_msgs::TransformStamped message;
    message.header.frame_id = "base_link";
    message.child_frame_id = "left_optical";
    message.transform.translation.z = place.translation().z();
    message.transform.rotation.w = q.w();
    message.transform.rotation.x = q.x();
    message.transform.rotation.y = q.y();
    message.transform.rotation.z = q.z();
    broadcaster_.sendTransform(message);
  }

 private:
  tf2_ros::StaticTransformBroadcaster broadcaster_;
};

}  // namespace fdp_stereo::test
