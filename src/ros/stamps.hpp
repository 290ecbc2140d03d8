// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <ros/time.h>

namespace fdp_stereo {

/// s. The difference of ros::Time throws beyond 68 years, and a header may hold any stamp.
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  const auto seconds = static_cast<double>(std::int64_t{to.sec} - std::int64_t{from.sec});
  return seconds + 1e-9 * static_cast<double>(std::int64_t{to.nsec} - std::int64_t{from.nsec});
}

}  // namespace fdp_stereo
