// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_frame.hpp"

#include <iterator>

namespace fdp_stereo {

void PointFrameCollector::clear() {
  newest_.fill(ros::Time());
  frames_.clear();
}

bool PointFrameCollector::hasNeeded(const PointFrame& frame, const Needs& needs) {
  return frame.disparity && frame.info && (frame.image || !needs.image);
}

bool PointFrameCollector::isComplete(const PointFrame& frame, const Needs& needs) {
  return hasNeeded(frame, needs) && (frame.confidence || !needs.confidence) &&
         (frame.depth_error || !needs.depth_error);
}

/// The newest complete frame, else the newest but one that has what it needs; older ones are forgotten.
std::optional<PointFrame> PointFrameCollector::take(const Needs& needs) {
  bool newer_waits = false;
  for (auto entry = frames_.rbegin(); entry != frames_.rend(); ++entry) {
    if (!hasNeeded(entry->second, needs)) continue;
    if (newer_waits || isComplete(entry->second, needs)) {
      std::optional<PointFrame> ready = entry->second;
      frames_.erase(frames_.begin(), entry.base());
      return ready;
    }
    newer_waits = true;
  }
  return std::nullopt;
}

}  // namespace fdp_stereo
