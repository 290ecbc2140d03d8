// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>

#include <boost/shared_ptr.hpp>

#include "stamps.hpp"

namespace fdp_stereo {

/// The newest messages of a topic, by stamp; thread-safe.
template <typename Message>
class StampedBuffer {
 public:
  using Ptr = boost::shared_ptr<const Message>;
  using Clock = std::chrono::steady_clock;

  void add(const Ptr& message, const ros::Time& stamp) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!entries_.empty() && stamp < entries_.back().stamp) entries_.clear();  // a bag that starts again
      entries_.push_back({stamp, message});
      if (entries_.size() > kLength) entries_.pop_front();
    }
    arrived_.notify_all();
  }

  /// The message nearest to `stamp`, at most max_age_s away, null where there is none. Where the source has been heard
  /// but not yet up to `stamp`, waits for it until `deadline` or until `cancel` (may be null) is set.
  Ptr nearest(const ros::Time& stamp, double max_age_s, Clock::time_point deadline, const std::atomic<bool>* cancel) {
    constexpr auto kLookForCancel = std::chrono::milliseconds(10);
    std::unique_lock<std::mutex> lock(mutex_);
    if (entries_.empty()) return nullptr;
    const auto done = [&] {
      return (cancel != nullptr && *cancel) || (!entries_.empty() && entries_.back().stamp >= stamp);
    };
    while (!done() && Clock::now() < deadline) {
      arrived_.wait_until(lock, std::min(deadline, Clock::now() + kLookForCancel), done);
    }
    Ptr best;
    double best_age = max_age_s;
    for (const Entry& entry : entries_) {
      const double age = std::abs(secondsBetween(entry.stamp, stamp));
      if (age > best_age) continue;
      best = entry.message;
      best_age = age;
    }
    return best;
  }

  bool heard() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !entries_.empty();
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.clear();
  }

 private:
  static constexpr std::size_t kLength = 10;
  struct Entry {
    ros::Time stamp;
    Ptr message;
  };
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Entry> entries_;
};

}  // namespace fdp_stereo
