// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rectifier.hpp"

#include <filesystem>
#include <limits>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "fdp_stereo/io.hpp"
#include "messages.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;
using sensor_msgs::CameraInfo;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

/// As image_proc does it, by OpenCV alone.
cv::Mat reference(const cv::Mat& raw, const CameraInfo& info) {
  cv::Mat map1, map2, rectified;
  const cv::Matx34d p(info.P.data());
  cv::initUndistortRectifyMap(cv::Matx33d(info.K.data()), info.D, cv::Matx33d(info.R.data()), p.get_minor<3, 3>(0, 0),
                              raw.size(), CV_16SC2, map1, map2);
  cv::remap(raw, rectified, map1, map2, cv::INTER_LINEAR);
  return rectified;
}

cv::Mat pixels(const sensor_msgs::Image& image) {
  return cv::Mat(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                 const_cast<std::uint8_t*>(image.data.data()), image.step);
}

void expectAsReference(const cv::Mat& raw, const CameraInfo& info) {
  Rectifier rectifier;
  const cv::Mat rectified = rectifier.rectify(raw, info, "info");
  EXPECT_TRUE(same(rectified, reference(raw, info)));
  const cv::Mat shown = reference(cv::Mat(raw.size(), CV_8UC1, cv::Scalar(255)), info);
  EXPECT_TRUE(same(rectifier.border(), shown < 255));
}

TEST(Rectifier, GivesThePixelsOfImageProc) {
  const test::Messages messages = test::rawMessages();
  expectAsReference(pixels(messages.left), messages.left_info);
  expectAsReference(pixels(messages.right), messages.right_info);
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{pixels(messages.left), pixels(messages.right), pixels(messages.left)}, colour);
  expectAsReference(colour, messages.left_info);
  cv::Mat deep;
  pixels(messages.left).convertTo(deep, CV_16UC1, 257.0);
  expectAsReference(deep, messages.left_info);
}

template <typename Values>
void readValues(const YAML::Node& node, Values& values) {
  const auto read = node["data"].as<std::vector<double>>();
  std::copy(read.begin(), read.end(), values.begin());
}

TEST(Rectifier, GivesThePixelsOfImageProcOnARecording) {
  const fs::path data = FDP_STEREO_SOURCE_DIR "/../shared/data/EuRoC-V1_01";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const std::pair<const char*, const char*> kViews[] = {{"left.yaml", "mav0/cam0/data"},
                                                        {"right.yaml", "mav0/cam1/data"}};
  for (const auto& [calibration, images] : kViews) {
    const YAML::Node yaml = YAML::LoadFile((data / calibration).string());
    CameraInfo info = test::cameraInfo(752, 480, 400.0, 376.0, 240.0, 0.0);
    readValues(yaml["distortion_coefficients"], info.D);
    readValues(yaml["camera_matrix"], info.K);
    readValues(yaml["rectification_matrix"], info.R);
    readValues(yaml["projection_matrix"], info.P);
    expectAsReference(readImage(fs::directory_iterator(data / images)->path().string()), info);
  }
}

TEST(Rectifier, TheBorderIsBlackAndTheRestIsTheScene) {
  const test::Messages messages = test::rawMessages();
  Rectifier rectifier;
  const cv::Mat rectified = rectifier.rectify(pixels(messages.left), messages.left_info, "info");
  const cv::Mat scene = test::planePair(240, 180, test::kPlaneDisparity).left;
  cv::Mat difference;
  cv::absdiff(rectified, scene, difference);
  const int border = cv::countNonZero(rectifier.border());
  EXPECT_GT(border, 100);
  EXPECT_LT(border, 240 * 180 / 4);
  EXPECT_LT(cv::mean(difference, ~rectifier.border())[0], 8.0);
}

TEST(Rectifier, FollowsTheCalibration) {
  const test::Messages messages = test::rawMessages();
  const cv::Mat raw = pixels(messages.left);
  Rectifier rectifier;
  for (const CameraInfo* info : {&messages.left_info, &messages.right_info, &messages.left_info}) {
    for (int repeat = 0; repeat < 2; ++repeat) {
      EXPECT_TRUE(same(rectifier.rectify(raw, *info, "info"), reference(raw, *info)));
    }
  }
}

TEST(Rectifier, LeavesARectifiedImageAlone) {
  const test::Messages raw = test::rawMessages();
  Rectifier rectifier;
  rectifier.rectify(pixels(raw.left), raw.left_info, "info");
  CameraInfo info = test::cameraInfo(240, 180, 200.0, 120.0, 90.0, -20.0);
  for (const bool with_rotation : {true, false}) {
    if (!with_rotation) info.R.fill(0.0);
    EXPECT_FALSE(needsRectification(info));
    EXPECT_EQ(rectifier.rectify(pixels(raw.left), info, "info").data, raw.left.data.data()) << "no copy";
    EXPECT_TRUE(rectifier.border().empty());
  }
}

/// image_proc leaves such an image as it is.
TEST(Rectifier, TurnsWithoutDistortion) {
  test::Messages messages = test::rawMessages();
  messages.left_info.D.assign(5, 0.0);
  expectAsReference(pixels(messages.left), messages.left_info);
}

TEST(Rectifier, RegionsAndBinningKeepThePlacesOfTheirPixels) {
  const test::Messages messages = test::rawMessages();
  CameraInfo info = messages.left_info;
  info.roi.x_offset = 40;
  info.roi.y_offset = 30;
  info.roi.width = 120;
  info.roi.height = 100;
  const cv::Rect part(40, 30, 120, 100);
  for (const bool do_rectify : {false, true}) {
    info.roi.do_rectify = do_rectify;
    Rectifier rectifier;
    const cv::Mat rectified = rectifier.rectify(pixels(messages.left)(part), info, "info");
    ASSERT_EQ(rectified.size(), part.size());
    cv::Mat difference;
    cv::absdiff(rectified, reference(pixels(messages.left), messages.left_info)(part), difference);
    EXPECT_LE(cv::mean(difference, ~rectifier.border())[0], 0.01);
  }
}

TEST(Rectifier, SaysWhatIsWrongWithACalibration) {
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    std::function<void(CameraInfo&)> spoil;
    std::vector<std::string> said;
  };
  const Case table[] = {
      {[&](CameraInfo& i) { i.D[1] = kNan; }, {"D[1] = nan"}},
      {[&](CameraInfo& i) { i.D.assign(5, kNan); }, {"D[0] = nan"}},
      {[&](CameraInfo& i) { i.K[2] = kNan; }, {"K[2] = nan"}},
      {[&](CameraInfo& i) { i.R[8] = -1.0 / 0.0; }, {"R[8] = -inf"}},
      {[](CameraInfo& i) { i.K.fill(0.0); }, {"K[0] = 0", "calibrate"}},
      {[](CameraInfo& i) { i.K[4] = -190.0; }, {"K[4] = -190"}},
      {[](CameraInfo& i) { i.R.fill(1.0); }, {"R is no rotation"}},
      {[](CameraInfo& i) { i.R[0] = 1e300; }, {"R is no rotation"}},
      {[](CameraInfo& i) { i.D.resize(3); }, {"'plumb_bob' with 3 values", "4 or 5"}},
      {[](CameraInfo& i) { i.D.assign(1000, 0.1); }, {"'plumb_bob' with 1000 values"}},
      {[](CameraInfo& i) { i.distortion_model = "fisheye\n"; }, {"'fisheye?' with 5 values", "equidistant"}},
      {[](CameraInfo& i) { i.K[2] = 1e9; }, {"shows nothing"}},
      {[](CameraInfo& i) { i.P[2] = -1e6; }, {"shows nothing"}},
      {[](CameraInfo& i) { i.width = i.height = 0xFFFFFFFFU; }, {"4294967295 x 4294967295"}},
      {[](CameraInfo& i) { i.width = i.height = 100000; }, {"100000 x 100000"}},
  };
  const test::Messages messages = test::rawMessages();
  Rectifier rectifier;
  for (const Case& c : table) {
    CameraInfo info = messages.left_info;
    c.spoil(info);
    const std::string error = test::errorOf([&] { rectifier.rectify(pixels(messages.left), info, "left/info"); });
    test::expectContains(error, {"left/info"});
    test::expectContains(error, c.said);
    EXPECT_TRUE(same(rectifier.rectify(pixels(messages.left), messages.left_info, ""),
                     reference(pixels(messages.left), messages.left_info)))
        << "recovers";
  }
}

TEST(Rectifier, KnowsTheNamesOfRectifiedImages) {
  for (const char* name : {"/a/image_rect", "image_rect_color", "/a/image_rect_raw/compressed"}) {
    EXPECT_TRUE(isRectifiedName(name)) << name;
  }
  for (const char* name : {"/rect/image_raw", "image_color", "image_unrectified"}) {
    EXPECT_FALSE(isRectifiedName(name)) << name;
  }
}

}  // namespace
}  // namespace fdp_stereo
