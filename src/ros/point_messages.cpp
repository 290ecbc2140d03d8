// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <sensor_msgs/point_cloud2_iterator.h>
#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "conversions.hpp"
#include "fdp_stereo/free_space.hpp"
#include "fdp_stereo/point_selection.hpp"
#include "text.hpp"

namespace fdp_stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

double checkedDepthScale(const stereo_msgs::DisparityImage& message, const std::string& topic) {
  const bool good = std::isfinite(message.f) && std::isfinite(message.T) && message.f > 0.0F && message.T > 0.0F;
  if (!good) {
    fail(topic, ": f = ", message.f, ", T = ", message.T,
         " give no depth; both must be > 0: calibrate the cameras, or look at what publishes it");
  }
  return static_cast<double>(message.f) * message.T;
}

void checkSameSize(const cv::Mat& map, const std::string& topic, const cv::Mat& disparity,
                   const std::string& disparity_topic) {
  if (map.size() == disparity.size()) return;
  fail(topic, ": ", map.cols, " x ", map.rows, " px but ", disparity_topic, " has ", disparity.cols, " x ",
       disparity.rows, "; take both from one node");
}

cv::Mat decodeColour(const sensor_msgs::Image& message, const std::string& topic) {
  cv::Mat image = decodeImage(message, topic);
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 256.0);
  if (image.channels() == 1) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
  return image;
}

cv::Mat decodeOptional(const sensor_msgs::ImageConstPtr& message, const std::string& topic) {
  return message ? decodeFloatImage(*message, topic) : cv::Mat();
}

void checkLimits(const PointView& view, const PointParams& params, const PointTopics& topics,
                 std::vector<std::string>& warnings) {
  if (params.min_confidence > 0.0 && view.confidence.empty()) {
    warnings.push_back(text("~min_confidence = ", params.min_confidence, " has no effect: nothing comes on ",
                            topics.confidence, "; start a node that publishes it, or set 0"));
  }
  if (params.max_depth_error > 0.0 && view.depth_error.empty()) {
    warnings.push_back(text("~max_depth_error = ", params.max_depth_error, " m has no effect: nothing comes on ",
                            topics.depth_error, "; start a node that publishes it, or set 0"));
  }
}

/// Marks what can be relied on, and what of it becomes a point.
void judge(const PointParams& params, PointView& view) {
  view.trusted = view.disparity == view.disparity;
  view.usable = view.disparity > std::max(params.max_depth > 0.0 ? view.depth_scale / params.max_depth : 0.0, 0.0);
  if (!view.confidence.empty()) {
    view.trusted &= view.confidence >= std::max(params.min_confidence, kSureOfFree);
    view.usable &= view.confidence >= params.min_confidence;
  }
  if (!view.depth_error.empty() && params.max_depth_error > 0.0) {
    view.usable &= view.depth_error <= params.max_depth_error;
  }
  view.usable.setTo(0, flyingPixels(view.disparity));
}

sensor_msgs::PointCloud2Ptr organisedCloud(const PointView& view, cv::Size size) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header = view.header;
  cloud->width = static_cast<std::uint32_t>(size.width);
  cloud->height = static_cast<std::uint32_t>(size.height);
  cloud->is_dense = 0U;
  return cloud;
}

float valueAt(const cv::Mat& map, cv::Point pixel) { return map.empty() ? kNan : map.at<float>(pixel); }

float packedColour(const cv::Mat& colour, cv::Point pixel) {
  if (colour.empty()) return 0.0F;
  const auto& bgr = colour.at<cv::Vec3b>(pixel);
  const std::uint32_t rgb = (std::uint32_t{bgr[2]} << 16) | (std::uint32_t{bgr[1]} << 8) | bgr[0];
  float packed = 0.0F;
  std::memcpy(&packed, &rgb, sizeof(packed));
  return packed;
}

void storeXyz(const PinholeCamera& camera, cv::Point pixel, double depth, float* out) {
  const Eigen::Vector3d point = camera.backProject(pixel.x, pixel.y, depth);
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(point[i]);
}

/// Six floats of a point; x < 0: none.
void storePoint(const PointView& view, cv::Point pixel, float* out) {
  if (pixel.x < 0 || view.usable.at<std::uint8_t>(pixel) == 0) {
    std::fill(out, out + 6, kNan);
    return;
  }
  storeXyz(view.camera, pixel, view.depth_scale / view.disparity.at<float>(pixel), out);
  out[3] = packedColour(view.colour, pixel);
  out[4] = valueAt(view.confidence, pixel);
  out[5] = valueAt(view.depth_error, pixel);
}

}  // namespace

PointView decodePointFrame(const PointFrame& frame, const PointParams& params, const PointTopics& topics,
                           std::vector<std::string>& warnings) {
  PointView view;
  view.frame = frame;
  view.header = frame.disparity->header;
  view.depth_scale = checkedDepthScale(*frame.disparity, topics.disparity);
  const float largest = frame.disparity->max_disparity;
  view.nearest = largest > 0.0F ? view.depth_scale / largest : 0.0;
  view.disparity = fromDisparityMessage(*frame.disparity, {}, topics.disparity);
  view.camera = checkedCamera(*frame.info, view.disparity.size(), topics.info, warnings);
  view.confidence = decodeOptional(frame.confidence, topics.confidence);
  view.depth_error = decodeOptional(frame.depth_error, topics.depth_error);
  if (frame.image) view.colour = decodeColour(*frame.image, topics.image);
  if (frame.image) checkSameSize(view.colour, topics.image, view.disparity, topics.disparity);
  if (frame.confidence) checkSameSize(view.confidence, topics.confidence, view.disparity, topics.disparity);
  if (frame.depth_error) checkSameSize(view.depth_error, topics.depth_error, view.disparity, topics.disparity);
  checkLimits(view, params, topics, warnings);
  judge(params, view);
  return view;
}

sensor_msgs::PointCloud2Ptr toPointCloud(const PointView& view, int decimation) {
  const cv::Mat pixels = decimation > 1 ? bestPixels(view.usable, view.confidence, decimation) : cv::Mat();
  auto cloud = organisedCloud(view, pixels.empty() ? view.disparity.size() : pixels.size());
  const auto type = sensor_msgs::PointField::FLOAT32;
  sensor_msgs::PointCloud2Modifier(*cloud).setPointCloud2Fields(6, "x", 1, type, "y", 1, type, "z", 1, type, "rgb", 1,
                                                                type, "confidence", 1, type, "depth_error", 1, type);
  sensor_msgs::PointCloud2Iterator<float> out(*cloud, "x");
  for (int y = 0; y < static_cast<int>(cloud->height); ++y) {
    for (int x = 0; x < static_cast<int>(cloud->width); ++x, ++out) {
      storePoint(view, pixels.empty() ? cv::Point(x, y) : cv::Point(pixels.at<cv::Vec2i>(y, x)), &out[0]);
    }
  }
  return cloud;
}

cv::Mat freeDepth(const PointView& view) {
  return view.depth_scale / freeDisparity(view.disparity, view.trusted, view.camera.fx, kFreeSpacing);
}

sensor_msgs::PointCloud2Ptr toFreeSpaceCloud(const PointView& view, const cv::Mat& free_depth) {
  auto cloud = organisedCloud(view, free_depth.size());
  const auto type = sensor_msgs::PointField::FLOAT32;
  sensor_msgs::PointCloud2Modifier(*cloud).setPointCloud2Fields(3, "x", 1, type, "y", 1, type, "z", 1, type);
  sensor_msgs::PointCloud2Iterator<float> out(*cloud, "x");
  for (int y = 0; y < free_depth.rows; ++y) {
    for (int x = 0; x < free_depth.cols; ++x, ++out) {
      storeXyz(view.camera, rayPixel({x, y}, kFreeSpacing, view.disparity.size()), free_depth.at<float>(y, x), &out[0]);
    }
  }
  return cloud;
}

sensor_msgs::LaserScanPtr toLaserScan(const PointView& view, const cv::Mat& free_depth,
                                      const Eigen::Isometry3d& scan_from_camera, const std::string& scan_frame,
                                      const RangeScanParams& params) {
  SeenDepth seen{view.camera, view.depth_scale / view.disparity, free_depth, kFreeSpacing, view.nearest};
  seen.depth.setTo(kNan, ~view.usable);
  const RangeScan ranges = scanRanges(seen, scan_from_camera, params);
  auto scan = boost::make_shared<sensor_msgs::LaserScan>();
  scan->header = view.header;
  scan->header.frame_id = scan_frame;
  scan->angle_increment = static_cast<float>(ranges.increment);
  scan->angle_min = static_cast<float>(std::remainder(ranges.first_bearing + ranges.increment / 2.0, 2.0 * M_PI));
  scan->angle_max = scan->angle_min + scan->angle_increment * (static_cast<float>(ranges.ranges.size()) - 1.0F);
  scan->range_min = static_cast<float>(params.min_range_m);
  scan->range_max = static_cast<float>(params.max_range_m);
  scan->ranges = ranges.ranges;
  const float seen_free = std::nextafter(scan->range_max, 0.0F);
  for (float& range : scan->ranges) {
    if (range > seen_free) range = seen_free;
  }
  return scan;
}

}  // namespace fdp_stereo
