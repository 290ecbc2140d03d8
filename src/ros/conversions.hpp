// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

#include "camera.hpp"
#include "fdp_stereo/types.hpp"

/// Images and maps to and from the core, as pure functions: no node, no clock, no state.
namespace fdp_stereo {

/// Pixels of the image. Native 8 and 16 bit mono and BGR share the message's memory (keep the message, never write);
/// the rest is converted. Returns CV_8U or CV_16U, 1 channel or 3 (BGR), row step as in the message.
/// Encodings: mono, bgr, rgb, bgra, rgba, bayer (8 and 16 bit), 8UC1, 8UC3, 16UC1, 16UC3, yuv422, yuv422_yuy2.
/// Throws std::invalid_argument naming `topic`, the value and the remedy; nothing is allocated before the checks.
cv::Mat decodeImage(const sensor_msgs::Image& message, const std::string& topic);

/// The same for 32FC1 (depth, disparity). Throws std::invalid_argument naming `topic`.
cv::Mat decodeFloatImage(const sensor_msgs::Image& message, const std::string& topic);

/// DisparityImage of a map (CV_32FC1 px, NaN = none). Invalid pixels are min_disparity - 1; min, max and invalid are in
/// published units (StereoGeometry::published). delta_d: the smallest step of the refinement, px.
/// valid_window: the columns in which the searched range can have a match inside the right image.
stereo_msgs::DisparityImagePtr toDisparityMessage(const cv::Mat& disparity, const std_msgs::Header& header,
                                                  const StereoGeometry& geometry, DisparityRange range, double delta_d);

/// The inverse: px of the left image (CV_32FC1), NaN outside [min_disparity, max_disparity] of the message.
/// Throws std::invalid_argument naming `topic`.
cv::Mat fromDisparityMessage(const stereo_msgs::DisparityImage& message, const StereoGeometry& geometry,
                             const std::string& topic);

struct DepthLimits {
  double min_m = 0.0;
  double max_m = 0.0;  ///< 0 = none
};

/// Depth along the optical axis, 32FC1 in metres, NaN = none or outside the limits (REP 118).
sensor_msgs::ImagePtr toDepthMessage(const cv::Mat& disparity, const std_msgs::Header& header,
                                     const StereoGeometry& geometry, DepthLimits limits);

/// Standard deviation of the depth, CV_32FC1 in metres: z^2 sigma / (f T); NaN where there is no depth or no sigma.
cv::Mat depthError(const cv::Mat& disparity, const cv::Mat& sigma, const StereoGeometry& geometry);

/// Grey or BGR of 8 or 16 bit, or a CV_32FC1 map, copied into a message. Throws std::invalid_argument for other types.
sensor_msgs::ImagePtr toImageMessage(const cv::Mat& image, const std_msgs::Header& header);

}  // namespace fdp_stereo
