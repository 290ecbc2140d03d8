// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>

namespace fdp_stereo {

/// Matches smaller images while pairs take longer than a deadline, and larger ones again when there is room. Down as
/// soon as two of the last twenty pairs were late, by as much as their times ask for; up one step at a time, when the
/// times of twenty pairs leave room for it, and of more where that was too early before.
class DeadlineController {
 public:
  /// The scale to match the next pair at. wanted: that of the parameters.
  double scale(double wanted) const { return scaleAt(level_, wanted); }
  /// What a pair took at scale(wanted).
  void record(double processing_ms, double deadline_ms, double wanted);
  /// A pair took nothing because it showed what the one before did: after some of them there is room.
  void recordRepeated();
  /// Other parameters take another time: what was measured says nothing.
  void forget();
  /// Pairs are late at the smallest scale, too.
  bool beyondReach() const { return beyond_reach_; }

 private:
  static constexpr std::size_t kWindow = 20;  ///< pairs

  static double scaleAt(std::size_t level, double wanted);
  void slowDown(double late_ms, double deadline_ms, double wanted);
  void moveTo(std::size_t level);
  double secondLargest() const;

  std::size_t level_ = 0;           ///< 0 = as wanted
  std::deque<double> times_ms_;     ///< of the last pairs at this level
  std::size_t pairs_ = 0;           ///< at this level
  std::size_t repeated_ = 0;        ///< pairs, without another between them
  std::size_t patience_ = kWindow;  ///< pairs with room before the next step up
  bool rose_ = false;               ///< to this level, from a smaller scale
  bool beyond_reach_ = false;
};

}  // namespace fdp_stereo
