// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "optimizers/local_expansion/grid_max_flow.hpp"
#include "optimizers/local_expansion/labels.hpp"
#include "optimizers/local_expansion/smoothness.hpp"

namespace fdp_stereo::local_expansion {

/// Offers planes to the pixels of one region: those for which taking it together lowers the energy most, do. Exact:
/// most pixels are decided by bounds, the others by a minimum cut. One per thread.
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
  /// [rows][pitch] floats of a MoveTask, with the readable margin around them.
  class Field {
   public:
    float* create(std::size_t size, std::size_t margin);
    float* data() { return values_.data() + margin_; }

   private:
    std::vector<float> values_;
    std::size_t margin_ = 0;
  };

  void prepare();
  void createFields();
  void copyLabels();
  bool hopeless(const float* costs) const;
  bool decide();
  void cut();
  void apply(const Plane& plane, const float* costs);
  std::ptrdiff_t at(int x, int y) const { return static_cast<std::ptrdiff_t>(y + 1) * task_.pitch + x + 1; }
  float edgeTo(std::ptrdiff_t p, int direction) const;

  Labels* labels_ = nullptr;
  const Smoothness* smoothness_ = nullptr;
  cv::Rect region_;
  bool prepared_ = false;    // the fields hold the labels
  bool keep_known_ = false;  // and the costs of keeping them
  MoveTask task_{};
  Field a_, b_, c_, cost_, inner_, keep_sum_, da_, db_, dd_, terminal_, total_, share_, lower_, upper_;
  std::array<Field, kPairDirections> weights_, keep_, edge_;
  std::vector<unsigned char> stale_;
  GridMaxFlow flow_;
};

}  // namespace fdp_stereo::local_expansion
