// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/corruption.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace fdp_stereo {
namespace {

/// A smooth scene of medium brightness, both views alike, at most `white` bright.
Scene smoothScene(int type, cv::Size size = {320, 240}, double white = 255.0) {
  Scene scene;
  scene.name = "smooth";
  cv::Mat view(size, CV_32FC(CV_MAT_CN(type)));
  cv::RNG(5).fill(view, cv::RNG::UNIFORM, 0.0, 1.0);
  cv::GaussianBlur(view, view, cv::Size(), 3.0);
  cv::normalize(view.reshape(1), view.reshape(1), 0.3 * white, 0.7 * white, cv::NORM_MINMAX);
  view.convertTo(scene.left, type);
  scene.left.row(0).setTo(cv::Scalar::all(white));  // tells how many bits there are
  scene.right = scene.left.clone();
  return scene;
}

Scene corrupted(Scene scene, const std::string& kind) {
  scene.left = scene.left.clone();
  scene.right = scene.right.clone();
  corrupt(scene, *chooseCorruptions({kind}).front());
  return scene;
}

/// Rows without the first, which is white, as float.
cv::Mat inner(const cv::Mat& view) {
  cv::Mat values;
  view.rowRange(8, view.rows).convertTo(values, CV_32F);
  return values;
}

double deviation(const cv::Mat& differences) {
  cv::Scalar mean;
  cv::Scalar deviations;
  cv::meanStdDev(differences, mean, deviations);
  return deviations[0];
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(Corruption, KeepsSizeAndTypeOfAnyPair) {
  for (const Corruption& kind : corruptions()) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
      for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 7), cv::Size(9, 1), cv::Size(33, 21)}) {
        Scene scene;
        scene.name = "one";
        scene.left = cv::Mat(size, type, cv::Scalar::all(200));
        scene.right = cv::Mat(size, type, cv::Scalar::all(100));
        corrupt(scene, kind);
        for (const cv::Mat& view : {scene.left, scene.right}) {
          EXPECT_EQ(view.type(), type) << kind.name;
          EXPECT_EQ(view.size(), size) << kind.name;
        }
      }
    }
  }
}

TEST(Corruption, EveryKindButNoneChangesTheRightViewAndRepeatsItself) {
  for (const Corruption& kind : corruptions()) {
    const Scene scene = smoothScene(CV_8UC3);
    const Scene once = corrupted(scene, kind.name);
    const Scene again = corrupted(scene, kind.name);
    EXPECT_EQ(same(once.right, scene.right), kind.name == std::string("none")) << kind.name;
    EXPECT_TRUE(same(once.left, again.left) && same(once.right, again.right)) << kind.name;
  }
}

TEST(Corruption, ScenesAndViewsHaveNoiseOfTheirOwn) {
  Scene scene = smoothScene(CV_8UC1);
  const Scene one = corrupted(scene, "noise");
  scene.name = "other";
  const Scene other = corrupted(scene, "noise");
  EXPECT_FALSE(same(one.left, other.left));
  EXPECT_NEAR(deviation(inner(one.left) - inner(one.right)), 5.0 * std::sqrt(2.0), 0.2);
}

TEST(Corruption, NoiseIsAsStrongAsToldInAnyNumberOfBits) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    for (const double white : {255.0, 4095.0, 65535.0}) {
      if (CV_MAT_DEPTH(type) == CV_8U && white > 255.0) continue;
      const Scene scene = smoothScene(type, {320, 240}, white);
      const Scene noisy = corrupted(scene, "noise");
      const Scene dark = corrupted(scene, "dark");
      const double level = white / 255.0;
      EXPECT_NEAR(deviation(inner(noisy.left) - inner(scene.left)), 5.0 * level, 0.1 * level) << type << ' ' << white;
      EXPECT_NEAR(deviation(inner(noisy.right) - inner(scene.right)), 5.0 * level, 0.1 * level) << type << ' ' << white;
      EXPECT_NEAR(deviation(inner(dark.left) - 0.25 * inner(scene.left)), 3.0 * level, 0.1 * level);
      EXPECT_NEAR(cv::mean(inner(dark.left))[0], 0.25 * cv::mean(inner(scene.left))[0], 0.5 * level);
    }
  }
}

TEST(Corruption, LightChangesAsTold) {
  const Scene scene = smoothScene(CV_8UC3);
  const cv::Mat before = inner(scene.right);
  EXPECT_LE(cv::norm(inner(corrupted(scene, "gain").right), 0.6 * before, cv::NORM_INF), 0.51);
  cv::Mat gamma;
  cv::pow(before / 255.0, 1.5, gamma);
  EXPECT_LE(cv::norm(inner(corrupted(scene, "gamma").right), 255.0 * gamma, cv::NORM_INF), 0.51);
  for (const char* kind : {"gain", "gamma", "blur", "rows"}) {
    EXPECT_TRUE(same(corrupted(scene, kind).left, scene.left)) << kind;
  }
  const Scene bright = corrupted(scene, "saturation");
  for (const cv::Mat& view : {bright.left, bright.right}) {
    EXPECT_TRUE(same(inner(view), cv::min(2.0 * before, 255.0)));
  }
}

TEST(Corruption, WhiteOfTwelveBitsIsCutOffThere) {
  const Scene bright = corrupted(smoothScene(CV_16UC1, {64, 48}, 4095.0), "saturation");
  double brightest = 0.0;
  cv::minMaxLoc(bright.left, nullptr, &brightest);
  EXPECT_DOUBLE_EQ(brightest, 4095.0);
}

TEST(Corruption, VignetteLeavesTheCentreAndDarkensTheCorners) {
  Scene scene;
  scene.name = "plain";
  scene.left = cv::Mat(101, 201, CV_8UC3, cv::Scalar::all(200));
  scene.right = scene.left.clone();
  const Scene dim = corrupted(scene, "vignette");
  for (const cv::Mat& view : {dim.left, dim.right}) {
    EXPECT_EQ(view.at<cv::Vec3b>(50, 100), cv::Vec3b(200, 200, 200));
    for (const cv::Point corner : {cv::Point(0, 0), cv::Point(200, 0), cv::Point(0, 100), cv::Point(200, 100)}) {
      EXPECT_EQ(view.at<cv::Vec3b>(corner), cv::Vec3b(60, 60, 60));
    }
  }
}

TEST(Corruption, RowsMoveDownByTheirOffset) {
  Scene scene;
  scene.name = "ramp";
  scene.left = cv::Mat(60, 201, CV_8UC1);
  for (int y = 0; y < 60; ++y) scene.left.row(y).setTo(4 * y);
  scene.right = scene.left.clone();
  const cv::Mat moved = corrupted(scene, "rows").right;
  EXPECT_NEAR(moved.at<std::uint8_t>(30, 0), 4 * 30 - 2, 1);
  EXPECT_NEAR(moved.at<std::uint8_t>(30, 100), 4 * 30 - 4, 1);
  EXPECT_NEAR(moved.at<std::uint8_t>(30, 200), 4 * 30 - 6, 1);
}

TEST(Corruption, BlurSpreadsAPointByItsDeviation) {
  Scene scene;
  scene.name = "edge";
  scene.left = cv::Mat(40, 40, CV_8UC1, cv::Scalar(0));
  scene.left.colRange(20, 40) = 250;
  scene.right = scene.left.clone();
  const cv::Mat blurred = corrupted(scene, "blur").right;
  // The share of a Gaussian of 1.5 px within .5 and 1.5 px of its middle.
  EXPECT_NEAR(blurred.at<std::uint8_t>(20, 20) - blurred.at<std::uint8_t>(20, 19), 250 * 0.262, 4);
  EXPECT_NEAR(blurred.at<std::uint8_t>(20, 21) - blurred.at<std::uint8_t>(20, 18), 250 * 0.683, 6);
}

TEST(Corruption, DirtLiesOnEachLensElsewhere) {
  Scene scene;
  scene.name = "plain";
  scene.left = cv::Mat(240, 320, CV_8UC1, cv::Scalar(200));
  scene.right = scene.left.clone();
  const Scene dirty = corrupted(scene, "dirt");
  EXPECT_FALSE(same(dirty.left, dirty.right));
  for (const cv::Mat& view : {dirty.left, dirty.right}) {
    const double covered = cv::countNonZero(view < 190) / static_cast<double>(view.total());
    EXPECT_GT(covered, 0.02);
    EXPECT_LT(covered, 0.2);
    double darkest = 0.0;
    cv::minMaxLoc(view, &darkest);
    EXPECT_GE(darkest, 60.0);
    EXPECT_LE(darkest, 80.0);
  }
}

TEST(Corruption, JpegTakesTheFineDetail) {
  Scene scene;
  scene.name = "random";
  scene.left = cv::Mat(64, 64, CV_8UC3);
  cv::RNG(1).fill(scene.left, cv::RNG::UNIFORM, 100, 156);
  scene.right = scene.left.clone();
  const Scene compressed = corrupted(scene, "jpeg");
  cv::Mat before;
  cv::Mat after;
  cv::Laplacian(scene.left, before, CV_32F);
  cv::Laplacian(compressed.left, after, CV_32F);
  EXPECT_LT(cv::norm(after, cv::NORM_L1), 0.7 * cv::norm(before, cv::NORM_L1));
}

TEST(Corruption, KindsAreChosenByNameInTheirOrder) {
  EXPECT_TRUE(chooseCorruptions({}).empty());
  EXPECT_EQ(chooseCorruptions({"all"}).size(), corruptions().size());
  const std::vector<const Corruption*> chosen = chooseCorruptions({"dirt", "JPEG", "dirt"});
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_STREQ(chosen[0]->name, "jpeg");
  EXPECT_STREQ(chosen[1]->name, "dirt");
  try {
    chooseCorruptions({"all", "snow"});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()), "'snow': must be one of " + corruptionNames() + " or all");
  }
}

TEST(Corruption, TheNameOfASceneTellsItsKind) {
  EXPECT_EQ(corrupted(smoothScene(CV_8UC1), "dark").name, "smooth+dark");
  EXPECT_EQ(corrupted(smoothScene(CV_8UC1), "none").name, "smooth");
  EXPECT_EQ(corruptionOf("smooth+dark"), "dark");
  EXPECT_EQ(corruptionOf("smooth"), "none");
  EXPECT_EQ(corruptionOf("+dark"), "none");
  EXPECT_EQ(corruptionOf("a+b"), "none");
}

}  // namespace
}  // namespace fdp_stereo
