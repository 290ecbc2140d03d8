// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "text.hpp"

namespace fdp_stereo {
namespace {

using sensor_msgs::CameraInfo;
using Warnings = std::vector<std::string>;

/// Focal lengths of a rectified pair are equal; a calibration file may round them.
constexpr double kMaxFocalDifference = 0.01;
/// Rows that differ by more are no rectified pair.
constexpr double kMaxRowDifferencePx = 2.0;
/// Beyond these a calibration is a mistake, and its values no longer fit the floats of a message.
constexpr double kMaxFocalPx = 1e6;
constexpr double kMaxCentrePx = 1e6;
constexpr double kMinBaselineM = 1e-6;
constexpr double kMaxBaselineM = 1e6;
/// Beyond these the unit is most probably another one.
constexpr double kShortBaselineM = 0.005;
constexpr double kLongBaselineM = 5.0;
/// Height of one camera over the other, as a share of the baseline, that rounding does not explain.
constexpr double kMaxTilt = 0.01;

void checkProjection(const CameraInfo& info, const std::string& topic) {
  for (std::size_t i = 0; i < info.P.size(); ++i) {
    if (!std::isfinite(info.P[i])) fail(topic, ": P[", i, "] = ", info.P[i], "; calibrate the camera anew");
  }
  if (std::all_of(info.P.begin(), info.P.end(), [](double p) { return p == 0.0; })) {
    fail(topic, ": P is all 0: the camera is not calibrated; run camera_calibration or load its file in the driver");
  }
  const auto possible = [](double focal_px) { return focal_px > 0.0 && focal_px <= kMaxFocalPx; };
  if (!possible(info.P[0]) || !possible(info.P[5])) {
    fail(topic, ": focal length P[0] = ", info.P[0], ", P[5] = ", info.P[5], " must be > 0 and at most ", kMaxFocalPx,
         " px; calibrate the camera");
  }
}

void checkSize(const CameraInfo& info, cv::Size image, const std::string& topic, Warnings& warnings) {
  if (info.width == 0 || info.height == 0) {
    warnings.push_back(text(topic, ": size is not set (", info.width, " x ", info.height, "); taken as the image's, ",
                            image.width, " x ", image.height));
    return;
  }
  const DescribedSize described = describedSize(info);
  if (described.width != static_cast<std::uint32_t>(image.width) ||
      described.height != static_cast<std::uint32_t>(image.height)) {
    fail(topic, ": describes ", described.width, " x ", described.height, " px (", info.width, " x ", info.height,
         ", binning ", info.binning_x, " x ", info.binning_y, ", roi ", info.roi.width, " x ", info.roi.height,
         ") but the image has ", image.width, " x ", image.height,
         "; load the calibration of this resolution, or set binning and roi");
  }
}

void checkCentre(const PinholeCamera& camera, const std::string& topic) {
  if (std::abs(camera.cx) <= kMaxCentrePx && std::abs(camera.cy) <= kMaxCentrePx) return;
  fail(topic, ": centre P[2] = ", camera.cx, ", P[6] = ", camera.cy, " px after binning and roi offset is beyond ",
       kMaxCentrePx, " px; correct them, or calibrate the camera anew");
}

/// The right camera is to the right of the left one, and not above or below it.
void checkPlaces(const PinholeCamera& left, const PinholeCamera& right, const StereoTopics& topics,
                 Warnings& warnings) {
  const double along = left.tx - right.tx;
  const double across = std::abs(left.ty - right.ty);
  if (across > 0.0 && across >= std::abs(along)) {
    fail(topics.right_info, ": P[7] = ", right.ty, " (left: ", left.ty, "), P[3] = ", right.tx, " (left: ", left.tx,
         "): one camera is above the other; only pairs side by side can be matched: turn both images by 90 degrees "
         "before they are calibrated and rectified");
  }
  if (along == 0.0) {
    fail(topics.right_info, ": P[3] = ", right.tx, " is the left's as well, so the baseline is 0: this is the ",
         "calibration of a single camera, or of the left one twice; run a stereo calibration");
  }
  if (along < 0.0) {
    fail(topics.left_info, ": P[3] = ", left.tx, " and ", topics.right_info, ": P[3] = ", right.tx,
         ": left and right are swapped; exchange the topics or cameras. P[3] is -fx * baseline: is its sign right?");
  }
  if (across > kMaxTilt * along) {
    warnings.push_back(text(topics.right_info, ": P[7] = ", right.ty, " (left: ", left.ty,
                            "): one camera is higher, so rows are off by more the nearer things are; run a stereo "
                            "calibration, which turns the images level"));
  }
}

double checkedBaseline(const PinholeCamera& left, const PinholeCamera& right, const std::string& topic,
                       Warnings& warnings) {
  const double baseline_m = (left.tx - right.tx) / right.fx;
  const std::string told = text(topic, ": P[3] = ", right.tx, " (left: ", left.tx, ") is a baseline of ", baseline_m,
                                " m; P[3] is -fx * baseline, in px and metres: ");
  if (!(baseline_m >= kMinBaselineM && baseline_m <= kMaxBaselineM)) {
    fail(told, "calibrate the cameras anew, in metres");
  }
  if (baseline_m > kLongBaselineM) {
    warnings.push_back(told + "was the size of the chessboard given in millimetres? Then divide P[3] by 1000");
  }
  if (baseline_m < kShortBaselineM) {
    warnings.push_back(told + "is it the baseline itself? Then multiply it by fx");
  }
  return baseline_m;
}

void checkPair(const PinholeCamera& left, const PinholeCamera& right, const StereoTopics& topics, Warnings& warnings) {
  const double focal_difference = std::abs(left.fx - right.fx) / right.fx;
  if (focal_difference > kMaxFocalDifference) {
    fail(topics.left_info, ": fx = ", left.fx, " px and ", topics.right_info, ": fx = ", right.fx,
         " px differ by more than 1 %; use the two files of one stereo calibration");
  }
  if (focal_difference > 0.0) {
    warnings.push_back(text(topics.left_info, ": fx = ", left.fx, " px differs from the right camera's ", right.fx,
                            " px, which is used"));
  }
  const double row_difference = left.cy - right.cy;
  if (std::abs(row_difference) > kMaxRowDifferencePx) {
    fail(topics.left_info, ": cy = ", left.cy, " px and ", topics.right_info, ": cy = ", right.cy,
         " px: the rows do not match; use the two files of one stereo calibration");
  }
  if (row_difference != 0.0) {
    warnings.push_back(text(topics.left_info, ": cy = ", left.cy, " px differs from the right camera's ", right.cy,
                            " px: rows are off by ", row_difference, " px"));
  }
}

}  // namespace

PinholeCamera pinholeCamera(const CameraInfo& info, cv::Size image_size) {
  PinholeCamera camera{info.P[0], info.P[5], info.P[2], info.P[6], image_size, info.P[3], info.P[7]};
  if (camera.fx == 0.0) camera = {info.K[0], info.K[4], info.K[2], info.K[5], image_size};
  const double bx = std::max(1U, info.binning_x);
  const double by = std::max(1U, info.binning_y);
  return {camera.fx / bx,
          camera.fy / by,
          (camera.cx - info.roi.x_offset) / bx,
          (camera.cy - info.roi.y_offset) / by,
          image_size,
          camera.tx / bx,
          camera.ty / by};
}

PinholeCamera checkedCamera(const CameraInfo& info, cv::Size image_size, const std::string& topic, Warnings& warnings) {
  checkProjection(info, topic);
  checkSize(info, image_size, topic, warnings);
  const PinholeCamera camera = pinholeCamera(info, image_size);
  checkCentre(camera, topic);
  return camera;
}

DescribedSize describedSize(const CameraInfo& info) {
  return {(info.roi.width != 0 ? info.roi.width : info.width) / std::max(1U, info.binning_x),
          (info.roi.height != 0 ? info.roi.height : info.height) / std::max(1U, info.binning_y)};
}

double StereoGeometry::depth(double disparity) const {
  const double d = published(disparity);
  return d > 0.0 ? focal_px * baseline_m / d : std::numeric_limits<double>::infinity();
}

StereoGeometry stereoGeometry(const CameraInfo& left, const CameraInfo& right, cv::Size image_size,
                              const StereoTopics& topics, Warnings& warnings) {
  const PinholeCamera l = checkedCamera(left, image_size, topics.left_info, warnings);
  const PinholeCamera r = checkedCamera(right, image_size, topics.right_info, warnings);
  checkPlaces(l, r, topics, warnings);
  checkPair(l, r, topics, warnings);
  const double baseline_m = checkedBaseline(l, r, topics.right_info, warnings);
  if (left.header.frame_id != right.header.frame_id) {
    warnings.push_back(text(topics.right_info, ": frame_id ", quoteForLog(right.header.frame_id),
                            " differs from the left's ", quoteForLog(left.header.frame_id),
                            "; a rectified pair shares the left optical frame"));
  }
  return {r.fx, baseline_m, l.cx - r.cx};
}

}  // namespace fdp_stereo
