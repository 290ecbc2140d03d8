// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seed_sources.hpp"

#include <algorithm>
#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <boost/make_shared.hpp>

#include "isometry.hpp"

namespace fdp_stereo {
namespace {

constexpr std::uint32_t kQueue = 5;

/// So many pixels of the other image lie in one square of the spacing.
int strideFor(double spacing_px, std::uint32_t width, int left_width) {
  return std::max(1, static_cast<int>(spacing_px * width / std::max(1, left_width) / 2.0));
}

}  // namespace

SeedSources::SeedSources(const ros::NodeHandle& node, StartParams& params)
    : node_(node),
      fixed_frame_(params.param<std::string>("seeds_fixed_frame", "")),
      points_topic_(node_.resolveName("seeds/points")),
      depth_topic_(node_.resolveName("seeds/depth")),
      disparity_topic_(node_.resolveName("seeds/disparity")),
      depth_pairs_(message_filters::sync_policies::ExactTime<sensor_msgs::Image, sensor_msgs::CameraInfo>(kQueue),
                   depth_image_, depth_info_) {
  depth_pairs_.registerCallback(&SeedSources::onDepth, this);
}

void SeedSources::onDepth(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info) {
  depth_buffer_.add(boost::make_shared<Depth>(Depth{image, info}), image->header.stamp);
}

void SeedSources::subscribe() {
  listener_ = std::make_unique<tf2_ros::TransformListener>(transforms_, node_, true);
  points_ = node_.subscribe<sensor_msgs::PointCloud2>(
      "seeds/points", kQueue,
      [this](const sensor_msgs::PointCloud2ConstPtr& m) { point_buffer_.add(m, m->header.stamp); });
  disparity_ = node_.subscribe<stereo_msgs::DisparityImage>(
      "seeds/disparity", kQueue,
      [this](const stereo_msgs::DisparityImageConstPtr& m) { disparity_buffer_.add(m, m->header.stamp); });
  depth_image_.subscribe(node_, "seeds/depth", kQueue);
  depth_info_.subscribe(node_, "seeds/camera_info", kQueue);
}

void SeedSources::unsubscribe() {
  points_.shutdown();
  disparity_.shutdown();
  depth_image_.unsubscribe();
  depth_info_.unsubscribe();
  listener_.reset();
  point_buffer_.clear();
  depth_buffer_.clear();
  disparity_buffer_.clear();
}

Seeds SeedSources::collect(const SeedRequest& request) {
  const NodeParams& params = request.settings.node;
  const std_msgs::Header& header = request.frame.left->header;
  const int left_width = request.left.size.width;
  Seeds seeds = seedsOf(request, point_buffer_, points_topic_, params.seeds_points_trust, SeedSource::kPoints,
                        [&](const sensor_msgs::PointCloud2& cloud) {
                          return toLeft(pointsOfCloud(cloud, points_topic_), cloud.header, header);
                        });
  const Seeds of_depth = seedsOf(
      request, depth_buffer_, depth_topic_, params.seeds_depth_trust, SeedSource::kDepth, [&](const Depth& depth) {
        const int stride = strideFor(params.seeds_spacing_px, depth.image->width, left_width);
        return toLeft(pointsOfDepth(*depth.image, *depth.info, stride, depth_topic_), depth.image->header, header);
      });
  const Seeds of_disparity = seedsOf(request, disparity_buffer_, disparity_topic_, params.seeds_disparity_trust,
                                     SeedSource::kDisparity, [&](const stereo_msgs::DisparityImage& disparity) {
                                       const int stride =
                                           strideFor(params.seeds_spacing_px, disparity.image.width, left_width);
                                       return pointsOfDisparity(disparity, request.left, stride, disparity_topic_);
                                     });
  seeds.insert(seeds.end(), of_depth.begin(), of_depth.end());
  seeds.insert(seeds.end(), of_disparity.begin(), of_disparity.end());
  return seeds;
}

template <typename Message, typename ToPoints>
Seeds SeedSources::seedsOf(const SeedRequest& request, StampedBuffer<Message>& buffer, const std::string& topic,
                           double trust, SeedSource source, const ToPoints& to_points) {
  if (trust <= 0.0 || !buffer.heard()) return {};
  const NodeParams& params = request.settings.node;
  const auto message =
      buffer.nearest(request.frame.left->header.stamp, params.seeds_max_age_s, request.deadline, request.cancel);
  if (!message) {
    request.warnings.push_back(
        topic + ": nothing within seeds_max_age of the image; it stopped, is late, or its clock differs");
    return {};
  }
  try {
    const SeedQuality quality{trust, params.seeds_spacing_px};
    Seeds seeds = projectSeeds(to_points(*message), request.left, request.geometry, quality, source);
    if (seeds.empty()) request.warnings.push_back(topic + ": none of its points is seen by the left camera");
    return seeds;
  } catch (const std::invalid_argument& error) {
    request.warnings.push_back(error.what());
  } catch (const tf2::TransformException& error) {
    request.warnings.push_back(topic + ": no transform to the left camera: " + error.what());
  } catch (const std::exception& error) {  // none of this may cost the disparity
    request.warnings.push_back(topic + ": not used: " + error.what());
  }
  return {};
}

Points SeedSources::toLeft(Points points, const std_msgs::Header& from, const std_msgs::Header& left) const {
  if (from.frame_id == left.frame_id && fixed_frame_.empty()) return points;
  const geometry_msgs::TransformStamped transform =
      fixed_frame_.empty()
          ? transforms_.lookupTransform(left.frame_id, from.frame_id, from.stamp)
          : transforms_.lookupTransform(left.frame_id, left.stamp, from.frame_id, from.stamp, fixed_frame_);
  const Eigen::Isometry3d left_from_sensor = toIsometry(transform.transform);
  for (Eigen::Vector3d& point : points) point = left_from_sensor * point;
  return points;
}

}  // namespace fdp_stereo
