// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "fdp_stereo/range_scan.hpp"
#include "point_frame.hpp"

/// Points, free space and scan of a disparity, as pure functions.
namespace fdp_stereo {

struct PointParams {
  int decimation = 1;            ///< px: the best point of each square of this side
  double min_confidence = 0.0;   ///< 0..1
  double max_depth_error = 0.0;  ///< m, 1 sigma; 0 = none
  double max_depth = 0.0;        ///< m; 0 = none
};

/// Names of the inputs for messages to people.
struct PointTopics {
  std::string disparity = "disparity";
  std::string info = "left/camera_info";
  std::string image = "left/image_rect";
  std::string confidence = "confidence";
  std::string depth_error = "depth_error";
};

/// A frame as the outputs need it. Maps have the size of the disparity; empty where the frame has none.
struct PointView {
  PointFrame frame;  ///< whose messages hold the pixels of the maps
  std_msgs::Header header;
  PinholeCamera camera;
  double depth_scale = 0.0;  ///< px m: depth = depth_scale / disparity
  double nearest = 0.0;      ///< m: the nearest depth that the searched range sees
  cv::Mat disparity;         ///< CV_32FC1 px, NaN = none
  cv::Mat colour;            ///< CV_8UC3, BGR
  cv::Mat confidence;        ///< CV_32FC1
  cv::Mat depth_error;       ///< CV_32FC1 m
  cv::Mat trusted;           ///< CV_8UC1: answered, and sure enough
  cv::Mat usable;            ///< CV_8UC1: of those, the pixels that give a point
};

/// Throws std::invalid_argument naming topic, value and remedy; appends to `warnings` what is usable but odd.
PointView decodePointFrame(const PointFrame& frame, const PointParams& params, const PointTopics& topics,
                           std::vector<std::string>& warnings);

/// x, y, z, rgb, confidence, depth_error; organised, NaN where there is no point or value.
sensor_msgs::PointCloud2Ptr toPointCloud(const PointView& view, int decimation);

/// How far the ray of each square of kFreeSpacing px is free: depth, CV_32FC1 m, NaN = not known.
constexpr int kFreeSpacing = 8;
cv::Mat freeDepth(const PointView& view);

/// The ends of these rays: x, y, z; organised, NaN where not known.
sensor_msgs::PointCloud2Ptr toFreeSpaceCloud(const PointView& view, const cv::Mat& free_depth);

/// Ranges that are free up to the end are a little less than range_max: what costmap_2d takes as seen.
sensor_msgs::LaserScanPtr toLaserScan(const PointView& view, const cv::Mat& free_depth,
                                      const Eigen::Isometry3d& scan_from_camera, const std::string& scan_frame,
                                      const RangeScanParams& params);

}  // namespace fdp_stereo
