// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "camera.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "messages.hpp"
#include "text.hpp"

namespace fdp_stereo {
namespace {

using test::cameraInfo;
using test::errorOf;
using test::expectContains;

constexpr int kWidth = 640;
constexpr int kHeight = 480;

struct Calibration {
  sensor_msgs::CameraInfo left = cameraInfo(kWidth, kHeight, 500.0, 330.0, 240.0, 0.0);
  sensor_msgs::CameraInfo right = cameraInfo(kWidth, kHeight, 500.0, 330.0, 240.0, -60.0);
  cv::Size size{kWidth, kHeight};
  std::vector<std::string> warnings;
  StereoGeometry geometry() { return stereoGeometry(left, right, size, {}, warnings); }
  std::string error() {
    return errorOf([&] { geometry(); });
  }
};

TEST(StereoGeometry, ParallelCameras) {
  Calibration c;
  const auto geometry = c.geometry();
  EXPECT_DOUBLE_EQ(geometry.focal_px, 500.0);
  EXPECT_DOUBLE_EQ(geometry.baseline_m, 0.12);
  EXPECT_DOUBLE_EQ(geometry.cx_offset_px, 0.0);
  EXPECT_TRUE(c.warnings.empty());
}

/// Rectified images have P; what describes the raw ones may be anything.
TEST(StereoGeometry, LooksOnlyAtP) {
  Calibration c;
  for (auto* info : {&c.left, &c.right}) {
    info->D.assign(3, NAN);
    info->K.fill(0.0);
    info->R.fill(NAN);
    info->distortion_model = "unknown";
  }
  EXPECT_DOUBLE_EQ(c.geometry().focal_px, 500.0);
  EXPECT_TRUE(c.warnings.empty());
}

TEST(StereoGeometry, VergedCameras) {
  Calibration c;
  c.right.P[2] = 350.0;
  EXPECT_DOUBLE_EQ(c.geometry().cx_offset_px, -20.0);
  EXPECT_DOUBLE_EQ(c.geometry().published(5.0), 25.0);
}

TEST(StereoGeometry, BinningAndRegionOfInterest) {
  Calibration c;
  for (auto* info : {&c.left, &c.right}) {
    info->binning_x = info->binning_y = 2;
    info->roi.x_offset = 20;
    info->roi.y_offset = 40;
    info->roi.width = 400;
    info->roi.height = 300;
  }
  c.right.roi.x_offset = 30;  // the right window starts 10 px further
  c.size = {200, 150};
  const auto geometry = c.geometry();
  EXPECT_DOUBLE_EQ(geometry.focal_px, 250.0);
  EXPECT_DOUBLE_EQ(geometry.baseline_m, 0.12);
  EXPECT_DOUBLE_EQ(geometry.cx_offset_px, 5.0);
}

TEST(StereoGeometry, UsableButOdd) {
  const std::vector<std::pair<std::function<void(Calibration&)>, std::string>> cases = {
      {[](Calibration& c) { c.right.header.frame_id = "right_optical"; }, "right_optical"},
      {[](Calibration& c) { c.left.P[0] = 502.0; }, "fx = 502"},
      {[](Calibration& c) { c.left.P[6] = 240.5; }, "cy = 240.5"},
      {[](Calibration& c) { c.left.width = c.left.height = 0; }, "size is not set"},
      {[](Calibration& c) { c.right.P[7] = -2.0; }, "P[7] = -2"},
  };
  for (const auto& [change, expected] : cases) {
    Calibration c;
    change(c);
    const auto geometry = c.geometry();
    EXPECT_DOUBLE_EQ(geometry.focal_px, 500.0) << expected;
    ASSERT_EQ(c.warnings.size(), 1U) << expected;
    expectContains(c.warnings[0], {"camera_info", expected});
  }
}

TEST(StereoGeometry, RefusesWhatGivesNoDepth) {
  const std::vector<std::pair<std::function<void(Calibration&)>, std::vector<std::string>>> cases = {
      {[](Calibration& c) { c.left.P[0] = NAN; }, {"left/camera_info", "P[0] = nan", "calibrate"}},
      {[](Calibration& c) { c.right.P[3] = -INFINITY; }, {"right/camera_info", "P[3] = -inf"}},
      {[](Calibration& c) { c.right.P.fill(0.0); }, {"right/camera_info", "all 0", "camera_calibration"}},
      {[](Calibration& c) { c.left.P[5] = -500.0; }, {"left/camera_info", "P[5] = -500"}},
      {[](Calibration& c) { c.right.P[3] = 0.0; }, {"right/camera_info", "P[3] = 0", "baseline is 0"}},
      {[](Calibration& c) { c.left.P[3] = c.right.P[3] = -60.0; },
       {"right/camera_info", "P[3] = -60", "baseline is 0"}},
      {[](Calibration& c) { c.left.P[3] = -100.0; }, {"left/camera_info", "P[3] = -100", "P[3] = -60", "swapped"}},
      {[](Calibration& c) {
         c.right.P[3] = 0.0;
         c.right.P[7] = -60.0;
       },
       {"right/camera_info", "P[7] = -60", "above the other", "90 degrees"}},
      {[](Calibration& c) { c.right.P[3] = 60.0; }, {"right/camera_info", "P[3] = 60", "swapped"}},
      {[](Calibration& c) { std::swap(c.left, c.right); }, {"left/camera_info", "P[3] = -60", "P[3] = 0", "swapped"}},
      {[](Calibration& c) { c.left.P[0] = 510.0; }, {"fx = 510", "fx = 500", "1 %"}},
      {[](Calibration& c) { c.left.P[6] = 250.0; }, {"cy = 250", "rows"}},
      {[](Calibration& c) { c.left.width = 320; }, {"left/camera_info", "320 x 480", "640 x 480"}},
      {[](Calibration& c) { c.right.binning_x = 2; }, {"right/camera_info", "320 x 480", "binning"}},
      {[](Calibration& c) { c.right.roi.width = 600; }, {"right/camera_info", "600 x 480", "roi"}},
      {[](Calibration& c) { c.right.binning_y = 4000000000U; }, {"right/camera_info", "640 x 0"}},
      {[](Calibration& c) { c.left.P[0] = 1e300; }, {"left/camera_info", "P[0] = 1e+300", "1e+06"}},
      {[](Calibration& c) { c.left.P[2] = -1e30; }, {"left/camera_info", "P[2] = -1e+30", "calibrate"}},
      {[](Calibration& c) { c.right.roi.x_offset = 0xFFFFFFFFU; }, {"right/camera_info", "P[2] = -4.29", "roi"}},
      {[](Calibration& c) { c.right.P[3] = -1e300; }, {"right/camera_info", "baseline of 2e+297 m", "metres"}},
      {[](Calibration& c) { c.right.P[3] = -1e-300; }, {"right/camera_info", "baseline of 2e-303 m"}},
  };
  for (const auto& [change, expected] : cases) {
    Calibration c;
    change(c);
    expectContains(c.error(), expected);
  }
}

/// The rig's frame may be anywhere: the right camera, a third one, the middle between both.
TEST(StereoGeometry, BaselineIsTheDistanceOfTheCameras) {
  const std::pair<double, double> pairs[] = {
      {0.0, -60.0}, {-60.0, -120.0}, {60.0, 0.0}, {30.0, -30.0}, {1000.0, 940.0}};
  for (const auto& [left, right] : pairs) {
    Calibration c;
    c.left.P[3] = left;
    c.right.P[3] = right;
    EXPECT_NEAR(c.geometry().baseline_m, 0.12, 1e-12) << left;
    EXPECT_TRUE(c.warnings.empty()) << c.warnings[0];
  }
}

/// Mistakes of unit; they may be none, so that the depth is given all the same.
TEST(StereoGeometry, UnlikelyBaselinesAreToldWithTheRemedy) {
  const std::pair<double, std::vector<std::string>> cases[] = {
      {-60000.0, {"right/camera_info", "P[3] = -60000", "120 m", "millimetres", "1000"}},
      {-1e8, {"200000 m", "millimetres"}},
      {-0.12, {"right/camera_info", "P[3] = -0.12", "0.00024 m", "multiply it by fx"}},
      {-0.01, {"2e-05 m", "baseline itself"}},
  };
  for (const auto& [tx, expected] : cases) {
    Calibration c;
    c.right.P[3] = tx;
    EXPECT_NEAR(c.geometry().baseline_m, -tx / 500.0, 1e-9);
    ASSERT_EQ(c.warnings.size(), 1U) << tx;
    expectContains(c.warnings[0], expected);
  }
  for (const double tx : {-2499.0, -2.51}) {
    Calibration c;
    c.right.P[3] = tx;
    c.geometry();
    EXPECT_TRUE(c.warnings.empty()) << tx;
  }
}

TEST(StereoGeometry, DepthOfADisparity) {
  const StereoGeometry geometry{500.0, 0.12, -20.0};
  EXPECT_DOUBLE_EQ(geometry.depth(10.0), 2.0);
  EXPECT_TRUE(std::isinf(geometry.depth(-20.0)));
  EXPECT_TRUE(std::isinf(geometry.depth(NAN)));
}

TEST(PinholeCamera, PBinnedAndCut) {
  auto info = cameraInfo(kWidth, kHeight, 500.0, 330.0, 240.0, -60.0);
  info.P[5] = 510.0;
  info.P[7] = 12.0;
  info.binning_x = 2;
  info.binning_y = 3;
  info.roi.x_offset = 20;
  info.roi.y_offset = 30;
  const PinholeCamera camera = pinholeCamera(info, {100, 50});
  EXPECT_DOUBLE_EQ(camera.fx, 250.0);
  EXPECT_DOUBLE_EQ(camera.fy, 170.0);
  EXPECT_DOUBLE_EQ(camera.cx, 155.0);
  EXPECT_DOUBLE_EQ(camera.cy, 70.0);
  EXPECT_DOUBLE_EQ(camera.tx, -30.0);
  EXPECT_DOUBLE_EQ(camera.ty, 4.0);
}

/// u = (P X)_0 / (P X)_2, written out.
TEST(PinholeCamera, ProjectsByTheWholeOfP) {
  auto info = cameraInfo(kWidth, kHeight, 500.0, 330.0, 240.0, -60.0);
  info.P[7] = 15.0;
  const PinholeCamera camera = pinholeCamera(info, {kWidth, kHeight});
  const Eigen::Vector3d point(0.4, -0.2, 2.0);
  const Eigen::Vector2d pixel = camera.project(point);
  EXPECT_DOUBLE_EQ(pixel.x(), (500.0 * 0.4 + 330.0 * 2.0 - 60.0) / 2.0);
  EXPECT_DOUBLE_EQ(pixel.y(), (500.0 * -0.2 + 240.0 * 2.0 + 15.0) / 2.0);
  EXPECT_LT((camera.backProject(pixel.x(), pixel.y(), 2.0) - point).norm(), 1e-12);
  const PinholeCamera half = camera.scaled(0.5, 0.5);
  EXPECT_DOUBLE_EQ(half.project(point).x(), (pixel.x() + 0.5) / 2.0 - 0.5);
  EXPECT_EQ(half.size, cv::Size(kWidth / 2, kHeight / 2));
}

TEST(QuoteForLog, ShortAndPrintable) {
  EXPECT_EQ(quoteForLog("mono8"), "'mono8'");
  EXPECT_EQ(quoteForLog(std::string("a\0\n\x1b\xff", 5) + "b"), "'a????b'");
  EXPECT_EQ(quoteForLog(std::string(100000, 'x')), "'" + std::string(40, 'x') + "'");
}

}  // namespace
}  // namespace fdp_stereo
