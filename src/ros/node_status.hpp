// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "frame_processor.hpp"
#include "pair_synchronizer.hpp"

/// What the node knows about itself, and how it is told to people. Plain values: the caller locks.
namespace fdp_stereo {

struct InputStatus {
  std::string topic;  ///< resolved
  std::uint32_t publishers = 0;
  InputCount count;
};

/// Counters since the start.
struct NodeStatus {
  std::array<InputStatus, 4> inputs;  ///< left image, left info, right image, right info
  bool subscribed = false;
  bool approximate_sync = false;
  std::uint64_t pairs = 0;
  std::uint64_t processed = 0;
  std::uint64_t failed = 0;
  std::uint64_t dropped = 0;    ///< replaced by a newer pair
  std::uint64_t over_rate = 0;  ///< left out by max_rate
  std::uint64_t too_old = 0;    ///< left out by max_age
  int waiting = 0;
  double processing_ms = 0.0;         ///< of the last pair
  double latency_ms = 0.0;            ///< from the arrival of the last pair to its publication
  double age_ms = 0.0;                ///< from its stamp to its publication
  double apart_ms = 0.0;              ///< from the stamp of its left image to that of its right one
  unsigned revision = 0;              ///< of the parameters it was processed with
  std::uint64_t temporal_resets = 0;  ///< pairs that nothing of earlier ones was used for
  std::string last_temporal_reset;    ///< why, the last time
  std::string last_error;
  bool error_is_current = false;  ///< the newest pair failed
  bool master_lost = false;
  FrameReport frame;  ///< of the last pair
};

/// Why no disparity came out since `before`, `seconds` ago, with counts per topic and the likely cause; "" where all is
/// well or nobody listens.
std::string describeSilence(const NodeStatus& now, const NodeStatus& before, double seconds);

/// The state of the node for /diagnostics; rates since `before`, `seconds` ago.
void describeStatus(const NodeStatus& now, const NodeStatus& before, double seconds,
                    diagnostic_updater::DiagnosticStatusWrapper& diagnostics);

/// Lets a text through when it is new: what keeps coming is said once, and again after it has stayed away for a while.
/// Never more than a few texts at a time.
class LogThrottle {
 public:
  using Clock = std::chrono::steady_clock;
  explicit LogThrottle(Clock::duration period, std::size_t max_lines) : period_(period), max_lines_(max_lines) {}
  bool allow(const std::string& text, Clock::time_point now);

 private:
  struct Line {
    std::string text;
    Clock::time_point time;
  };
  Clock::duration period_;
  std::size_t max_lines_;
  std::vector<Line> recent_;
};

}  // namespace fdp_stereo
