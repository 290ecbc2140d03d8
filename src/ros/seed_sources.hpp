// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/node_handle.h>
#include <tf2_ros/transform_listener.h>

#include "frame_processor.hpp"
#include "stamped_buffer.hpp"
#include "start_params.hpp"

namespace fdp_stereo {

/// seeds/points, seeds/depth with seeds/camera_info, seeds/disparity: all optional, none can stop the disparity.
class SeedSources {
 public:
  /// Reads `~seeds_fixed_frame`: the frame that stands still while the robot moves, for the time between a cloud and
  /// the image; empty = both are taken as of one time.
  SeedSources(const ros::NodeHandle& node, StartParams& params);

  void subscribe();
  void unsubscribe();

  /// A SeedProvider.
  Seeds collect(const SeedRequest& request);

 private:
  struct Depth {
    sensor_msgs::ImageConstPtr image;
    sensor_msgs::CameraInfoConstPtr info;
  };
  void onDepth(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info);
  template <typename Message, typename ToPoints>
  Seeds seedsOf(const SeedRequest& request, StampedBuffer<Message>& buffer, const std::string& topic, double trust,
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
