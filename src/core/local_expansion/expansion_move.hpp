// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "local_expansion/grid_max_flow.hpp"
#include "local_expansion/labels.hpp"
#include "local_expansion/smoothness.hpp"

namespace fdp_stereo::local_expansion {

/// Offers planes to the pixels of one region: those for which taking it together lowers the energy most, do. Exact, by
/// a minimum cut. One per thread.
class ExpansionMove {
 public:
  /// Starts work on `region`. Labels next to it must not change until the next call.
  void begin(const Smoothness& smoothness, const cv::Rect& region, Labels& labels);
  /// Offers one plane with its data terms costs[] (rows of the region); returns the change of the energy, never above
  /// 0.
  double offer(const Plane& plane, const float* costs);
  /// The same without smoothness: every pixel whose data term falls takes the plane.
  double offerUnary(const Plane& plane, const float* costs);

 private:
  void computeKeep();
  bool hopeless(const float* costs) const;
  void computeTerms(const Plane& plane, const float* costs);
  void fixBorder();
  // What the terms alone decide: -1 nobody wants the plane, 1 everybody does, 0 open.
  int obvious() const;
  void cut();
  double change() const;
  void apply(const Plane& plane, const float* costs);
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * outer_.width + x; }

  Labels* labels_ = nullptr;
  cv::Rect region_;
  cv::Rect outer_;  // the region and the ring of pixels around it, which keep their labels
  cv::Rect inner_;  // the region within outer_
  bool keep_known_ = false;
  MoveTask move_{};
  std::array<std::vector<float>, kPairDirections> keep_, edge_;
  std::vector<float> terminal_, scratch_;
  std::vector<float> keep_sum_;      // of the region: current data term and all pairs of a pixel
  std::vector<std::uint8_t> takes_;  // of the region
  GridMaxFlow flow_;
};

}  // namespace fdp_stereo::local_expansion
