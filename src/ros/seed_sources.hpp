// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/node_handle.h>
#include <tf2_ros/transform_listener.h>

#include "frame_processor.hpp"
#include "stamps.hpp"
#include "start_params.hpp"

namespace fdp_stereo {

/// The newest messages of a topic, by stamp; thread-safe.
template <typename Message>
class StampedBuffer {
 public:
  using Ptr = boost::shared_ptr<const Message>;

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
  /// but not yet up to `stamp`, waits for it at most wait_s.
  Ptr nearest(const ros::Time& stamp, double max_age_s, double wait_s) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (entries_.empty()) return nullptr;
    arrived_.wait_for(lock, std::chrono::duration<double>(wait_s),
                      [&] { return !entries_.empty() && entries_.back().stamp >= stamp; });
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

/// seeds/points, seeds/depth with seeds/camera_info, seeds/disparity: all optional, none can stop the disparity.
class SeedSources {
 public:
  /// Reads `~seeds_fixed_frame`: the frame that stands still while the robot moves, for the time between a cloud and
  /// the image; empty = both are taken as of one time.
  SeedSources(const ros::NodeHandle& node, StartParams& params);

  void subscribe();
  void unsubscribe();

  /// A SeedProvider.
  Seeds collect(const StereoFrame& frame, const NodeSettings& settings, const PinholeCamera& left,
                const StereoGeometry& geometry, std::vector<std::string>& warnings);

 private:
  struct Depth {
    sensor_msgs::ImageConstPtr image;
    sensor_msgs::CameraInfoConstPtr info;
  };
  /// One call of collect().
  struct Request {
    const StereoFrame& frame;
    const NodeParams& params;
    const PinholeCamera& left;
    const StereoGeometry& geometry;
    std::vector<std::string>& warnings;
    Seeds seeds;
  };

  void onDepth(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info);
  template <typename Message, typename ToPoints>
  void addSource(Request& request, StampedBuffer<Message>& buffer, const std::string& topic, double trust,
                 SeedSource source, const ToPoints& to_points);
  Points toLeft(Points points, const std_msgs::Header& from, const std_msgs::Header& left) const;

  ros::NodeHandle node_;
  std::string fixed_frame_;
  std::string points_topic_, depth_topic_, disparity_topic_;
  tf2_ros::Buffer transforms_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
  ros::Subscriber points_, disparity_;
  message_filters::Subscriber<sensor_msgs::Image> depth_image_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> depth_info_;
  message_filters::Synchronizer<message_filters::sync_policies::ExactTime<sensor_msgs::Image, sensor_msgs::CameraInfo>>
      depth_pairs_;
  StampedBuffer<sensor_msgs::PointCloud2> point_buffer_;
  StampedBuffer<Depth> depth_buffer_;
  StampedBuffer<stereo_msgs::DisparityImage> disparity_buffer_;
};

}  // namespace fdp_stereo
