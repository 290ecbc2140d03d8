// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/time.h>

#include "frame_worker.hpp"

namespace fdp_stereo {

struct PairSynchronizerParams {
  int queue_size = 5;        ///< messages per topic that wait for their partners, at least 1
  bool approximate = false;  ///< near stamps make a pair, not only equal ones
  double tolerance_s = 0.0;  ///< approximate: largest distance of the stamps of a pair; 0 = none
};

/// What came in on one topic.
struct InputCount {
  std::uint64_t received = 0;
  ros::Time stamp;  ///< of the newest message
};

/// Makes pairs of the messages of four topics. No node needed. Messages of all topics are added by one thread at a
/// time; the counts may be read by others.
class PairSynchronizer {
 public:
  enum Input { kLeftImage, kLeftInfo, kRightImage, kRightInfo };
  using Counts = std::array<InputCount, 4>;

  struct Callbacks {
    std::function<void(const StereoFrame& frame)> pair;
    /// The stamps jumped back, as those of a bag that starts again: nothing waits any more.
    std::function<void()> restarted;
    /// The stamp of a message cannot be computed with.
    std::function<void(Input input, const ros::Time& stamp)> hostile_stamp;
  };

  PairSynchronizer(const PairSynchronizerParams& params, Callbacks callbacks);

  /// input: kLeftImage or kRightImage.
  void add(Input input, const sensor_msgs::ImageConstPtr& image);
  /// input: kLeftInfo or kRightInfo.
  void add(Input input, const sensor_msgs::CameraInfoConstPtr& info);

  Counts counts() const;

 private:
  template <typename Policy>
  using Synchronizer = message_filters::Synchronizer<Policy>;
  using Image = sensor_msgs::Image;
  using CameraInfo = sensor_msgs::CameraInfo;
  using ExactPolicy = message_filters::sync_policies::ExactTime<Image, CameraInfo, Image, CameraInfo>;
  using ApproximatePolicy = message_filters::sync_policies::ApproximateTime<Image, CameraInfo, Image, CameraInfo>;

  template <typename Message>
  void pass(Input input, const boost::shared_ptr<const Message>& message, message_filters::PassThrough<Message>& to);
  /// True where the stamps jumped back.
  bool count(Input input, const ros::Time& stamp);
  void reset();
  template <typename Sync>
  void connect(Sync& sync);
  void onPair(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
              const sensor_msgs::ImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info);

  PairSynchronizerParams params_;
  Callbacks callbacks_;
  mutable std::mutex mutex_;
  Counts counts_;
  // One pass-through per topic, so that a synchroniser can be replaced: it cannot be emptied.
  message_filters::PassThrough<Image> left_image_, right_image_;
  message_filters::PassThrough<CameraInfo> left_info_, right_info_;
  std::unique_ptr<Synchronizer<ExactPolicy>> exact_;
  std::unique_ptr<Synchronizer<ApproximatePolicy>> approximate_;
};

}  // namespace fdp_stereo
