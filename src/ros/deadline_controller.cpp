// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "deadline_controller.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace fdp_stereo {
namespace {

constexpr std::array<double, 6> kSteps = {1.0, 0.8, 0.65, 0.5, 0.4, 0.3};  ///< of the scale wanted
constexpr double kSmallest = 0.25;                                         ///< that pipeline.scale allows
constexpr double kRoom = 0.85;                                             ///< of the deadline
constexpr std::size_t kMostPatience = 320;                                 ///< pairs

/// Exponents by which the time follows the scale, about 1.9: guessed on the slow side both ways.
constexpr double kGrowth = 2.2;
constexpr double kShrinkage = 1.7;

}  // namespace

double DeadlineController::scaleAt(std::size_t level, double wanted) {
  return std::min(wanted, std::max(kSmallest, wanted * kSteps[std::min(level, kSteps.size() - 1)]));
}

void DeadlineController::record(double processing_ms, double deadline_ms, double wanted) {
  repeated_ = 0;
  if (pairs_++ == 0) return;  // it gets its memory first
  times_ms_.push_back(processing_ms);
  if (times_ms_.size() > kWindow) times_ms_.pop_front();
  const double slow_ms = secondLargest();
  if (slow_ms > deadline_ms) return slowDown(slow_ms, deadline_ms, wanted);
  if (pairs_ <= kWindow) return;
  beyond_reach_ = false;
  if (level_ == 0) return;
  const double predicted_ms = slow_ms * std::pow(scaleAt(level_ - 1, wanted) / scale(wanted), kGrowth);
  const bool plenty = predicted_ms < 0.5 * kRoom * deadline_ms;
  if (predicted_ms > kRoom * deadline_ms || (!plenty && pairs_ <= patience_)) return;
  moveTo(level_ - 1);
  rose_ = true;
}

void DeadlineController::recordRepeated() {
  if (level_ == 0 || ++repeated_ < kWindow) return;
  moveTo(level_ - 1);
  rose_ = true;
}

void DeadlineController::slowDown(double late_ms, double deadline_ms, double wanted) {
  const bool too_early = rose_ && pairs_ <= 2 * patience_;
  std::size_t level = level_;
  double predicted_ms = late_ms;
  while (predicted_ms > kRoom * deadline_ms && scaleAt(level + 1, wanted) < scaleAt(level, wanted)) {
    ++level;
    predicted_ms = late_ms * std::pow(scaleAt(level, wanted) / scale(wanted), kShrinkage);
  }
  patience_ = too_early ? std::min(2 * patience_, kMostPatience) : kWindow;
  beyond_reach_ = level == level_;
  moveTo(level);
}

void DeadlineController::moveTo(std::size_t level) {
  level_ = level;
  rose_ = false;
  forget();
}

void DeadlineController::forget() {
  times_ms_.clear();
  pairs_ = 0;
  repeated_ = 0;
}

/// A single slow pair does not count.
double DeadlineController::secondLargest() const {
  if (times_ms_.size() < 2) return 0.0;
  std::deque<double> sorted = times_ms_;
  std::nth_element(sorted.begin(), sorted.begin() + 1, sorted.end(), std::greater<>());
  return sorted[1];
}

}  // namespace fdp_stereo
