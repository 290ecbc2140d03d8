// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>
#include <rosbag/message_instance.h>
#include <sensor_msgs/CameraInfo.h>

#include "conversions.hpp"

namespace fdp_stereo {

/// An image of a recording that is read when it is needed: what waits for its partner takes no memory.
struct BagImage {
  ros::Time stamp;
  boost::shared_ptr<const rosbag::MessageInstance> message;  ///< none: no image, but the end of the recording
};
using BagImageConstPtr = boost::shared_ptr<const BagImage>;

}  // namespace fdp_stereo

namespace ros::message_traits {
template <>
struct TimeStamp<fdp_stereo::BagImage> {
  static ros::Time value(const fdp_stereo::BagImage& image) { return image.stamp; }
};
}  // namespace ros::message_traits

namespace fdp_stereo {

enum Input { kLeftImage, kLeftInfo, kRightImage, kRightInfo };

/// Images and calibrations of one moment.
struct BagPair {
  BagImageConstPtr left, right;
  sensor_msgs::CameraInfoConstPtr left_info, right_info;
};

struct SyncOptions {
  bool approximate = false;
  double tolerance_s = 0.0;  ///< 0 = none
};

/// The nearest that stamps of two topics came to each other.
class StampDistance {
 public:
  void add(bool first, const ros::Time& stamp);
  double seconds() const { return nearest_s_; }

 private:
  std::array<std::optional<ros::Time>, 2> last_;
  double nearest_s_ = std::numeric_limits<double>::infinity();
};

/// Puts images and calibrations together by their stamps: equal ones, or like the node with approximate_sync.
class PairCollector {
 public:
  explicit PairCollector(const SyncOptions& options) : options_(options) { restart(); }

  void addImage(Input side, BagImageConstPtr image);
  void addInfo(Input side, const sensor_msgs::CameraInfoConstPtr& info);
  /// No more comes: what is known to fit is a pair.
  void finish();
  /// The oldest pair that has not been taken.
  std::optional<BagPair> take();

  std::size_t imagesWithoutPartner() const { return images_ - 2 * pairs_; }
  /// Why there are no pairs, and what to do.
  std::string silence(const StereoTopics& topics) const;

 private:
  using Policy = message_filters::sync_policies::ApproximateTime<BagImage, sensor_msgs::CameraInfo, BagImage,
                                                                 sensor_msgs::CameraInfo>;

  void restart();
  void watchStamp(Input input, const ros::Time& stamp);
  template <int kInput, typename MessagePtr>
  void addApproximate(const MessagePtr& message, const ros::Time& stamp);
  void completeAt(const ros::Time& stamp);
  void onPair(const BagImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
              const BagImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info);

  SyncOptions options_;
  std::map<ros::Time, BagPair> waiting_;  ///< exact
  std::unique_ptr<message_filters::Synchronizer<Policy>> approximate_;
  std::deque<BagPair> ready_;
  std::size_t images_ = 0;
  std::size_t pairs_ = 0;
  ros::Time newest_;
  std::array<std::optional<ros::Time>, 4> last_;
  StampDistance images_distance_, left_info_distance_, right_info_distance_;
};

}  // namespace fdp_stereo
