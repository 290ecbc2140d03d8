// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

class SceneTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  void writeText(const std::string& name, const std::string& text) { std::ofstream(root_ / name) << text; }
  void writePicture(const std::string& name, cv::Size size = {6, 4}) {
    fs::create_directories((root_ / name).parent_path());
    writeImage((root_ / name).string(), cv::Mat(size, CV_8UC1, cv::Scalar(90)));
  }
  /// A map of `value` px with no disparity at (0, 0).
  void writeMap(const std::string& name, float value, cv::Size size = {6, 4}) {
    fs::create_directories((root_ / name).parent_path());
    cv::Mat map(size, CV_32FC1, cv::Scalar(value));
    map.at<float>(0, 0) = kInvalidDisparity;
    writeDisparity((root_ / name).string(), map);
  }
  void writeMiddlebury(const std::string& folder) {
    writePicture(folder + "/im0.png");
    writePicture(folder + "/im1.png");
    writeMap(folder + "/disp0GT.pfm", 2.5F);
  }
  std::string path(const std::string& name = "") const { return (root_ / name).string(); }
  std::string errorOf(const std::string& name) const {
    try {
      for (const SceneFiles& files : findScenes(path(name))) readScene(files);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  fs::path root_ = fs::path(testing::TempDir()) /
                   ("fdp_stereo_scene_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(SceneTest, ReadsAMiddleburyFolder) {
  writeMiddlebury("Teddy");
  writePicture("Teddy/mask0nocc.png");
  writeText("Teddy/calib.txt", "doffs=3\nndisp=48\nisint=0\n");
  const std::vector<SceneFiles> found = findScenes(path("Teddy") + "/");
  ASSERT_EQ(found.size(), 1U);
  const Scene scene = readScene(found[0]);
  EXPECT_EQ(scene.name, "Teddy");
  EXPECT_EQ(scene.num_disparities, 48);
  EXPECT_FLOAT_EQ(scene.truth.at<float>(1, 1), 2.5F);
  EXPECT_TRUE(std::isnan(scene.truth.at<float>(0, 0)));
  EXPECT_EQ(scene.mask.at<std::uint8_t>(2, 2), 90);
}

TEST_F(SceneTest, TakesTheRangeFromTheTruthWhereThereIsNoCalibration) {
  writeMiddlebury("a");
  EXPECT_EQ(readScene(findScenes(path("a"))[0]).num_disparities, 7);
}

TEST_F(SceneTest, ReadsPngTruthWithItsScale) {
  writePicture("a/im0.png");
  writePicture("a/im1.png");
  writePicture("a/disp0GT.png");
  writeText("a/disp0GT.scale.txt", "scale=4.5\n");
  EXPECT_FLOAT_EQ(readScene(findScenes(path("a"))[0]).truth.at<float>(0, 0), 20.0F);
  writeText("a/disp0GT.scale.txt", "scale=0\n");
  EXPECT_NE(errorOf("a").find("disp0GT.scale.txt"), std::string::npos);
}

TEST_F(SceneTest, ReadsAKittiFolder) {
  for (const char* frame : {"000001_10.png", "000000_10.png", "000000_11.png"}) {
    writePicture(std::string("image_0/") + frame);
    writePicture(std::string("image_1/") + frame);
    writeMap(std::string("disp_occ/") + frame, 8.0F);
    writeMap(std::string("disp_noc/") + frame, 8.0F);
  }
  cv::Mat visible(4, 6, CV_32FC1, cv::Scalar(kInvalidDisparity));
  visible.at<float>(1, 1) = 8.0F;
  writeDisparity(path("disp_noc/000000_10.png"), visible);
  const std::vector<SceneFiles> found = findScenes(path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "000000_10");
  const Scene scene = readScene(found[0]);
  EXPECT_EQ(scene.mask.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(scene.mask.at<std::uint8_t>(0, 1), 128);
  EXPECT_EQ(scene.mask.at<std::uint8_t>(1, 1), 255);
  EXPECT_EQ(scene.num_disparities, 12);
}

TEST_F(SceneTest, FindsScenesInSubFoldersByName) {
  writeMiddlebury("b");
  writeMiddlebury("a");
  const std::vector<SceneFiles> found = findScenes(path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "a");
}

TEST_F(SceneTest, NamesTheFileThatIsMissingOrBroken) {
  EXPECT_NE(errorOf("none").find("none: no such folder"), std::string::npos);
  fs::create_directories(root_ / "empty");
  EXPECT_NE(errorOf("empty").find("holds neither"), std::string::npos);
  writeMiddlebury("a");
  fs::remove(root_ / "a/im1.png");
  EXPECT_NE(errorOf("a").find("im1.png: missing"), std::string::npos);
  writePicture("a/im1.png", {5, 4});
  EXPECT_NE(errorOf("a").find("im1.png: is 5 x 4 px, the left image 6 x 4"), std::string::npos);
  writePicture("a/im1.png");
  writeMap("a/disp0GT.pfm", 1.0F, {6, 5});
  EXPECT_NE(errorOf("a").find("disp0GT.pfm: is 6 x 5"), std::string::npos);
  fs::remove(root_ / "a/disp0GT.pfm");
  EXPECT_NE(errorOf("a").find("has no ground truth"), std::string::npos);
  writeMap("a/disp0GT.pfm", kInvalidDisparity);
  EXPECT_NE(errorOf("a").find("holds no disparity"), std::string::npos);
}

}  // namespace
}  // namespace fdp_stereo
