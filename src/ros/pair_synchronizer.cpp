// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair_synchronizer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stamps.hpp"

namespace fdp_stereo {
namespace {

/// A stamp that is older than its predecessor by more than this is a bag that starts again, not a late message.
constexpr double kJumpBack = 0.5;  // s

}  // namespace

PairSynchronizer::PairSynchronizer(const PairSynchronizerParams& params, Callbacks callbacks)
    : params_(params), callbacks_(std::move(callbacks)) {
  reset();
}

void PairSynchronizer::add(Input input, const sensor_msgs::ImageConstPtr& image) {
  pass(input, image, input == kLeftImage ? left_image_ : right_image_);
}

void PairSynchronizer::add(Input input, const sensor_msgs::CameraInfoConstPtr& info) {
  pass(input, info, input == kLeftInfo ? left_info_ : right_info_);
}

PairSynchronizer::Counts PairSynchronizer::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

template <typename Message>
void PairSynchronizer::pass(Input input, const boost::shared_ptr<const Message>& message,
                            message_filters::PassThrough<Message>& to) {
  const ros::Time stamp = message->header.stamp;
  if (count(input, stamp)) {
    reset();
    callbacks_.restarted();
  }
  try {
    to.add(ros::MessageEvent<const Message>(message, stamp));  // a time of arrival would need a clock
  } catch (const std::runtime_error&) {                        // ApproximateTime computes with stamps
    callbacks_.hostile_stamp(input, stamp);
    reset();
  }
}

bool PairSynchronizer::count(Input input, const ros::Time& stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  InputCount& count = counts_[input];
  const bool jumped_back = count.received > 0 && secondsBetween(stamp, count.stamp) > kJumpBack;
  ++count.received;
  count.stamp = stamp;
  if (jumped_back) {
    for (InputCount& other : counts_) other.stamp = std::min(other.stamp, stamp);
  }
  return jumped_back;
}

void PairSynchronizer::reset() {
  exact_.reset();
  approximate_.reset();
  const auto queue_size = static_cast<std::uint32_t>(params_.queue_size);
  if (params_.approximate) {
    ApproximatePolicy policy(queue_size);
    if (params_.tolerance_s > 0.0) policy.setMaxIntervalDuration(ros::Duration(params_.tolerance_s));
    approximate_ = std::make_unique<Synchronizer<ApproximatePolicy>>(policy);
    connect(*approximate_);
  } else {
    exact_ = std::make_unique<Synchronizer<ExactPolicy>>(ExactPolicy(queue_size));
    connect(*exact_);
  }
}

template <typename Sync>
void PairSynchronizer::connect(Sync& sync) {
  sync.connectInput(left_image_, left_info_, right_image_, right_info_);
  sync.registerCallback(&PairSynchronizer::onPair, this);
}

void PairSynchronizer::onPair(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
                              const sensor_msgs::ImageConstPtr& right,
                              const sensor_msgs::CameraInfoConstPtr& right_info) {
  callbacks_.pair({left, right, left_info, right_info, std::chrono::steady_clock::now()});
}

}  // namespace fdp_stereo
