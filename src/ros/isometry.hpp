// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Transform.h>
#include <Eigen/Geometry>

namespace fdp_stereo {

inline Eigen::Isometry3d toIsometry(const geometry_msgs::Transform& transform) {
  const auto& q = transform.rotation;
  const auto& t = transform.translation;
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  isometry.translation() = Eigen::Vector3d(t.x, t.y, t.z);
  return isometry;
}

}  // namespace fdp_stereo
