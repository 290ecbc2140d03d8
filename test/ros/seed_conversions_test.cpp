// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seed_conversions.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "messages.hpp"

namespace fdp_stereo {
namespace {

using test::errorOf;

const PinholeCamera kLeft{200.0, 200.0, 80.0, 60.0, cv::Size(160, 120)};
const StereoGeometry kGeometry{200.0, 0.1, -5.0};
constexpr char kTopic[] = "seeds/points";

sensor_msgs::PointCloud2 makeCloud(const std::vector<cv::Point3f>& points) {
  sensor_msgs::PointCloud2 cloud;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(points.size());
  sensor_msgs::PointCloud2Iterator<float> xyz(cloud, "x");
  for (const auto& point : points) {
    xyz[0] = point.x;
    xyz[1] = point.y;
    xyz[2] = point.z;
    ++xyz;
  }
  return cloud;
}

TEST(ProjectSeeds, PixelAndDisparityOfAPoint) {
  const SeedQuality quality{0.8, 1.0};
  const Seeds seeds = projectSeeds({{0.1, -0.05, 2.0}}, kLeft, kGeometry, quality, SeedSource::kPoints);
  ASSERT_EQ(seeds.size(), 1U);
  EXPECT_FLOAT_EQ(seeds[0].x, 90.0F);  // 200 * 0.1 / 2 + 80
  EXPECT_FLOAT_EQ(seeds[0].y, 55.0F);  // 200 * -0.05 / 2 + 60
  EXPECT_FLOAT_EQ(seeds[0].d, 5.0F);   // published 200 * 0.1 / 2 = 10, as given 10 - 5
  EXPECT_FLOAT_EQ(seeds[0].trust, 0.8F);
  EXPECT_EQ(seeds[0].source, SeedSource::kPoints);
}

/// The left camera 0.05 m beside the origin of its frame.
TEST(ProjectSeeds, ProjectsByTheWholeOfP) {
  PinholeCamera left = kLeft;
  left.tx = -10.0;
  const Seeds seeds = projectSeeds({{0.15, -0.05, 2.0}}, left, kGeometry, {0.8, 1.0}, SeedSource::kPoints);
  ASSERT_EQ(seeds.size(), 1U);
  EXPECT_FLOAT_EQ(seeds[0].x, 90.0F);  // (200 * 0.15 - 10) / 2 + 80
  EXPECT_FLOAT_EQ(seeds[0].d, 5.0F);
}

TEST(ProjectSeeds, LeavesOutWhatTheCameraCannotSee) {
  const Points points = {{0.0, 0.0, -1.0}, {0.0, 0.0, 0.0}, {5.0, 0.0, 1.0}, {0.0, -5.0, 1.0}, {1e30, 0.0, 1e-30}};
  EXPECT_TRUE(projectSeeds(points, kLeft, kGeometry, {}, SeedSource::kPoints).empty());
}

TEST(ProjectSeeds, PointsBehindNearerOnesAreHidden) {
  const SeedQuality quality{0.9, 4.0};
  // Pixels (80, 60), and 3 px beside it but twice as far; a third one far away in the image.
  const Points points = {{0.0, 0.0, 1.0}, {0.03, 0.0, 2.0}, {0.6, 0.0, 2.0}};
  const Seeds seeds = projectSeeds(points, kLeft, kGeometry, quality, SeedSource::kPoints);
  ASSERT_EQ(seeds.size(), 2U);
  EXPECT_FLOAT_EQ(seeds[0].d, 15.0F);
  EXPECT_FLOAT_EQ(seeds[1].x, 140.0F);
}

TEST(ProjectSeeds, OnePerSquare) {
  Points points;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) points.emplace_back(x / 200.0, y / 200.0, 1.0 + 1e-6 * (x + y));
  }
  const Seeds seeds = projectSeeds(points, kLeft, kGeometry, {0.9, 4.0}, SeedSource::kPoints);
  EXPECT_EQ(seeds.size(), 100U);
}

TEST(PointsOfCloud, FinitePoints) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto cloud = makeCloud({{1.0F, 2.0F, 3.0F}, {nan, nan, nan}, {4.0F, 5.0F, 6.0F}, {0.0F, 0.0F, INFINITY}});
  const Points points = pointsOfCloud(cloud, kTopic);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1], Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST(PointsOfCloud, RefusesLayoutsThatDoNotFit) {
  const auto good = makeCloud({{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}});
  const auto error = [&](const std::function<void(sensor_msgs::PointCloud2&)>& spoil) {
    auto cloud = good;
    spoil(cloud);
    return errorOf([&] { pointsOfCloud(cloud, kTopic); });
  };
  EXPECT_NE(error([](auto& c) { c.fields.clear(); }).find("no field x"), std::string::npos);
  EXPECT_NE(error([](auto& c) { c.fields[2].datatype = 8; }).find("not FLOAT32"), std::string::npos);
  EXPECT_NE(error([](auto& c) { c.fields[1].offset = 0xFFFFFFFFU; }).find("outside a point"), std::string::npos);
  EXPECT_NE(error([](auto& c) { c.point_step = 4; }).find("outside a point"), std::string::npos);
  EXPECT_NE(error([](auto& c) { c.data.pop_back(); }).find("too few"), std::string::npos);
  EXPECT_NE(error([](auto& c) { c.width = 0xFFFFFFFFU; }).find("too few"), std::string::npos);
  EXPECT_NE(error([](auto& c) { c.height = 0xFFFFFFFFU; }).find("too few"), std::string::npos);
  EXPECT_NE(error([](auto& c) {
              c.height = 2;
              c.row_step = 0;
            }).find("too few"),
            std::string::npos);
  EXPECT_NE(error([](auto& c) { c.is_bigendian = 1; }).find("big-endian"), std::string::npos);
  EXPECT_EQ(error([](auto& c) { c.width = c.height = 0; }), "");
}

/// Found by fuzz_messages: four thousand million rows without a point took half a minute.
TEST(PointsOfCloud, RowsWithoutPointsGiveNone) {
  auto cloud = makeCloud({{1.0F, 2.0F, 3.0F}});
  cloud.height = 0xFFFFFFFFU;
  cloud.width = cloud.row_step = 0;
  EXPECT_TRUE(pointsOfCloud(cloud, kTopic).empty());
}

TEST(PointsOfDepth, MillimetresAndMetresOfAnyResolution) {
  cv::Mat metres(30, 40, CV_32FC1, cv::Scalar(2.0));
  metres.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  metres.at<float>(0, 1) = 0.0F;
  cv::Mat millimetres;
  metres.convertTo(millimetres, CV_16UC1, 1000.0);
  millimetres.at<std::uint16_t>(0, 0) = 0;
  const auto quarter = test::cameraInfo(40, 30, 50.0, 19.625, 14.625, 0.0);
  const auto full = test::cameraInfo(160, 120, 200.0, 80.0, 60.0, 0.0);
  for (const auto& info : {quarter, full}) {
    const Points a = pointsOfDepth(test::imageMessage(metres, "32FC1"), info, 1, "seeds/depth");
    const Points b = pointsOfDepth(test::imageMessage(millimetres, "16UC1"), info, 1, "seeds/depth");
    ASSERT_EQ(a.size(), 1198U);
    ASSERT_EQ(b.size(), 1198U);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-6);
    const Seeds seeds = projectSeeds(a, kLeft, kGeometry, {0.9, 1.0}, SeedSource::kDepth);
    EXPECT_FLOAT_EQ(seeds[0].d, 5.0F);
    EXPECT_NEAR(seeds[0].x, 4 * 2 + 1.5, 1e-3) << "the centre of four pixels";
  }
}

/// What the node publishes as depth comes back to the same pixels, wherever the origin of the frame is.
TEST(PointsOfDepth, OfACameraBesideItsOrigin) {
  const auto info = test::cameraInfo(160, 120, 200.0, 80.0, 60.0, -10.0);
  const cv::Mat metres(120, 160, CV_32FC1, cv::Scalar(2.0));
  const PinholeCamera left = pinholeCamera(info, metres.size());
  const Points points = pointsOfDepth(test::imageMessage(metres, "32FC1"), info, 7, "seeds/depth");
  EXPECT_NEAR(points[0].x(), (-80.0 * 2.0 + 10.0) / 200.0, 1e-12);
  const Seeds seeds = projectSeeds(points, left, kGeometry, {0.9, 1.0}, SeedSource::kDepth);
  ASSERT_EQ(seeds.size(), points.size());
  EXPECT_NEAR(seeds[1].x, 7.0, 1e-4);
  const auto message =
      toDisparityMessage(cv::Mat(120, 160, CV_32FC1, cv::Scalar(10)), {}, {200.0, 0.1, 0.0}, {0, 32}, 1);
  const Points of_disparity = pointsOfDisparity(*message, left, 7, "seeds/disparity");
  ASSERT_EQ(of_disparity.size(), points.size());
  EXPECT_LT((of_disparity[1] - points[1]).norm(), 1e-6);
}

TEST(PointsOfDepth, BinnedInfo) {
  auto info = test::cameraInfo(160, 120, 200.0, 80.0, 60.0, 0.0);
  info.binning_x = info.binning_y = 2;
  const cv::Mat metres(60, 80, CV_32FC1, cv::Scalar(2.0));
  const Points points = pointsOfDepth(test::imageMessage(metres, "32FC1"), info, 1, "seeds/depth");
  EXPECT_NEAR(points[0].x(), -40.0 * 2.0 / 100.0, 1e-12);
}

TEST(PointsOfDepth, RefusesWhatIsNoDepth) {
  const auto info = test::cameraInfo(40, 30, 50.0, 20.0, 15.0, 0.0);
  const cv::Mat bytes(30, 40, CV_8UC3, cv::Scalar::all(1));
  EXPECT_NE(errorOf([&] { pointsOfDepth(test::imageMessage(bytes, "bgr8"), info, 1, "seeds/depth"); }).find("32FC1"),
            std::string::npos);
  const auto depth = test::imageMessage(cv::Mat(30, 40, CV_32FC1, cv::Scalar(1)), "32FC1");
  EXPECT_NE(errorOf([&] { pointsOfDepth(depth, {}, 1, "seeds/depth"); }).find("calibrate"), std::string::npos);
}

TEST(PointsOfDisparity, ScalesWithResolutionAndBaseline) {
  // Half the resolution, another baseline: f T / d = 2 m.
  const cv::Mat map(60, 80, CV_32FC1, cv::Scalar(100.0 * 0.2 / 2.0));
  const auto message = toDisparityMessage(map, {}, {100.0, 0.2, 0.0}, {0, 32}, 1.0);
  const Points points = pointsOfDisparity(*message, kLeft, 4, "seeds/disparity");
  ASSERT_EQ(points.size(), 300U);
  const Seeds seeds = projectSeeds(points, kLeft, kGeometry, {0.9, 1.0}, SeedSource::kDisparity);
  EXPECT_NEAR(seeds[0].d, 5.0, 1e-4);
  EXPECT_NEAR(seeds[0].x, 0.5, 1e-3);
}

TEST(PointsOfDisparity, RefusesMessagesWithoutDepth) {
  auto message = *toDisparityMessage(cv::Mat(60, 80, CV_32FC1, cv::Scalar(3)), {}, {100.0, 0.2, 0.0}, {0, 32}, 1.0);
  message.T = 0.0F;
  EXPECT_NE(errorOf([&] { pointsOfDisparity(message, kLeft, 4, "seeds/disparity"); }).find("T = 0"), std::string::npos);
}

}  // namespace
}  // namespace fdp_stereo
