// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "messages.hpp"

namespace fdp_stereo {
namespace {

using test::errorOf;
using test::expectContains;
using test::imageMessage;

constexpr char kTopic[] = "/cam/left/image_rect";

cv::Mat noise(int type, int rows = 12, int cols = 18) {
  cv::Mat image(rows, cols, type);
  cv::RNG rng(7);
  rng.fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_8U ? 256 : 65536);
  return image;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(DecodeImage, NativeEncodingsShareTheMessage) {
  for (const auto& [encoding, type] : std::vector<std::pair<std::string, int>>{{"mono8", CV_8UC1},
                                                                               {"8UC1", CV_8UC1},
                                                                               {"mono16", CV_16UC1},
                                                                               {"16UC1", CV_16UC1},
                                                                               {"bgr8", CV_8UC3},
                                                                               {"8UC3", CV_8UC3},
                                                                               {"bgr16", CV_16UC3},
                                                                               {"16UC3", CV_16UC3}}) {
    const cv::Mat pixels = noise(type);
    const auto message = imageMessage(pixels, encoding);
    const cv::Mat decoded = decodeImage(message, kTopic);
    EXPECT_TRUE(equal(decoded, pixels)) << encoding;
    EXPECT_EQ(decoded.data, message.data.data()) << encoding;
  }
}

TEST(DecodeImage, PaddedRows) {
  for (const std::uint32_t padding : {1U, 2U, 14U}) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
      const cv::Mat pixels = noise(type);
      const std::string encoding = type == CV_8UC1 ? "mono8" : type == CV_8UC3 ? "bgr8" : "mono16";
      auto message = imageMessage(pixels, encoding, padding);
      EXPECT_TRUE(equal(decodeImage(message, kTopic), pixels)) << encoding << " + " << padding;
      message.data.resize(message.data.size() - padding);  // the last row need not be padded
      EXPECT_TRUE(equal(decodeImage(message, kTopic), pixels)) << encoding << " + " << padding << ", last row cut";
    }
  }
}

TEST(DecodeImage, OneRow) {
  const cv::Mat pixels = noise(CV_8UC1, 1, 18);
  EXPECT_TRUE(equal(decodeImage(imageMessage(pixels, "mono8", 3), kTopic), pixels));
}

TEST(DecodeImage, ColourOrders) {
  for (const int depth : {CV_8U, CV_16U}) {
    const std::string bits = depth == CV_8U ? "8" : "16";
    const cv::Mat bgr = noise(CV_MAKETYPE(depth, 3));
    cv::Mat rgb(bgr.size(), bgr.type());
    cv::mixChannels(bgr, rgb, {0, 2, 1, 1, 2, 0});
    EXPECT_TRUE(equal(decodeImage(imageMessage(rgb, "rgb" + bits), kTopic), bgr));
    cv::Mat bgra(bgr.size(), CV_MAKETYPE(depth, 4), cv::Scalar::all(9));
    cv::mixChannels(bgr, bgra, {0, 0, 1, 1, 2, 2});
    EXPECT_TRUE(equal(decodeImage(imageMessage(bgra, "bgra" + bits), kTopic), bgr));
    cv::Mat rgba(bgr.size(), CV_MAKETYPE(depth, 4), cv::Scalar::all(9));
    cv::mixChannels(rgb, rgba, {0, 0, 1, 1, 2, 2});
    EXPECT_TRUE(equal(decodeImage(imageMessage(rgba, "rgba" + bits), kTopic), bgr));
  }
}

/// A constant colour seen through the mosaic comes back as that colour, away from the border.
TEST(DecodeImage, BayerPatterns) {
  const cv::Vec3i bgr(40, 90, 200);
  for (const int depth : {CV_8U, CV_16U}) {
    for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
      cv::Mat mosaic(8, 8, CV_32SC1);
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
          const char colour = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
          mosaic.at<int>(y, x) = colour == 'b' ? bgr[0] : colour == 'g' ? bgr[1] : bgr[2];
        }
      }
      cv::Mat raw;
      mosaic.convertTo(raw, CV_MAKETYPE(depth, 1));
      const std::string encoding = "bayer_" + pattern + (depth == CV_8U ? "8" : "16");
      cv::Mat decoded;
      decodeImage(imageMessage(raw, encoding), kTopic).convertTo(decoded, CV_32S);
      ASSERT_EQ(decoded.channels(), 3) << encoding;
      EXPECT_EQ(decoded.at<cv::Vec3i>(4, 4), bgr) << encoding;
      EXPECT_EQ(decoded.at<cv::Vec3i>(3, 4), bgr) << encoding;
    }
  }
}

TEST(DecodeImage, BigEndian) {
  const cv::Mat pixels = noise(CV_16UC1);
  auto message = imageMessage(pixels, "mono16");
  for (std::size_t i = 0; i + 1 < message.data.size(); i += 2) std::swap(message.data[i], message.data[i + 1]);
  message.is_bigendian = 1;
  EXPECT_TRUE(equal(decodeImage(message, kTopic), pixels));
}

TEST(DecodeImage, BigEndianFlagOfBytesMeansNothing) {
  const cv::Mat pixels = noise(CV_8UC1);
  auto message = imageMessage(pixels, "mono8");
  message.is_bigendian = 1;
  EXPECT_TRUE(equal(decodeImage(message, kTopic), pixels));
}

TEST(DecodeImage, YuvGrey) {
  cv::Mat raw(4, 6, CV_8UC2);
  raw.setTo(cv::Scalar(128, 100));  // u/v, y
  const cv::Mat decoded = decodeImage(imageMessage(raw, "yuv422"), kTopic);
  ASSERT_EQ(decoded.type(), CV_8UC3);
  const auto pixel = decoded.at<cv::Vec3b>(1, 1);
  EXPECT_EQ(pixel[0], pixel[1]);
  EXPECT_EQ(pixel[1], pixel[2]);
  EXPECT_NEAR(pixel[0], (100 - 16) * 255.0 / 219.0, 1.5);
}

TEST(DecodeImage, RefusesWhatIsNoImage) {
  const auto good = imageMessage(noise(CV_8UC1), "mono8");
  auto message = good;
  const auto error = [&] { return errorOf([&] { decodeImage(message, kTopic); }); };

  message.encoding = "32FC1";
  expectContains(error(), {kTopic, "'32FC1'", "mono8"});
  message.encoding = "";
  expectContains(error(), {kTopic, "encoding ''"});
  message = good;
  message.width = 0;
  expectContains(error(), {kTopic, "0 x 12"});
  message = good;
  message.step = 17;
  expectContains(error(), {kTopic, "step 17", "18"});
  message = good;
  message.data.clear();
  expectContains(error(), {kTopic, "data has 0 bytes", "216"});
  message = good;
  message.data.pop_back();
  expectContains(error(), {kTopic, "215", "216"});
  message = good;
  message.width = message.height = 100000;
  message.step = 100000;
  expectContains(error(), {kTopic, "100000 x 100000"});
  message = good;
  message.width = message.height = message.step = 0xFFFFFFFFU;
  expectContains(error(), {kTopic, "4294967295"});
  message = imageMessage(noise(CV_8UC2, 4, 5), "yuv422");
  expectContains(error(), {kTopic, "width 5", "even"});
}

class DisparityMessage : public ::testing::Test {
 protected:
  DisparityMessage() {
    header_.stamp = ros::Time(12, 34);
    header_.frame_id = "left_optical";
    map_.at<float>(1, 2) = kInvalidDisparity;
  }
  cv::Mat map_ = cv::Mat(4, 100, CV_32FC1, cv::Scalar(10.25));
  std_msgs::Header header_;
  StereoGeometry geometry_{500.0, 0.12, 0.0};
};

float pixel(const sensor_msgs::Image& image, int x, int y) {
  return *reinterpret_cast<const float*>(image.data.data() + static_cast<std::size_t>(y) * image.step + 4 * x);
}

TEST_F(DisparityMessage, Fields) {
  const auto message = toDisparityMessage(map_, header_, geometry_, {4, 32}, 0.0625);
  EXPECT_EQ(message->header.stamp, header_.stamp);
  EXPECT_EQ(message->header.frame_id, "left_optical");
  EXPECT_EQ(message->image.header.stamp, header_.stamp);
  EXPECT_EQ(message->image.header.frame_id, "left_optical");
  EXPECT_EQ(message->image.encoding, "32FC1");
  EXPECT_EQ(message->image.width, 100U);
  EXPECT_EQ(message->image.height, 4U);
  EXPECT_EQ(message->image.step, 400U);
  EXPECT_EQ(message->image.data.size(), 1600U);
  EXPECT_FLOAT_EQ(message->f, 500.0F);
  EXPECT_FLOAT_EQ(message->T, 0.12F);
  EXPECT_FLOAT_EQ(message->min_disparity, 4.0F);
  EXPECT_FLOAT_EQ(message->max_disparity, 35.0F);
  EXPECT_FLOAT_EQ(message->delta_d, 0.0625F);
  EXPECT_FLOAT_EQ(pixel(message->image, 0, 0), 10.25F);
  EXPECT_FLOAT_EQ(pixel(message->image, 2, 1), 3.0F);
}

TEST_F(DisparityMessage, VergedCamerasShiftValuesRangeAndInvalid) {
  geometry_.cx_offset_px = -20.0;
  const auto message = toDisparityMessage(map_, header_, geometry_, {-4, 32}, 1.0);
  EXPECT_FLOAT_EQ(message->min_disparity, 16.0F);
  EXPECT_FLOAT_EQ(message->max_disparity, 47.0F);
  EXPECT_FLOAT_EQ(pixel(message->image, 0, 0), 30.25F);
  EXPECT_FLOAT_EQ(pixel(message->image, 2, 1), 15.0F);
}

TEST_F(DisparityMessage, ValidWindowLiesInsideAndFollowsTheRange) {
  const auto window = [&](int min, int count) {
    return toDisparityMessage(map_, header_, geometry_, {min, count}, 1.0)->valid_window;
  };
  EXPECT_EQ(window(0, 32).x_offset, 0U);  // x = 0 can still see d = 0
  EXPECT_EQ(window(0, 32).width, 100U);
  EXPECT_EQ(window(10, 32).x_offset, 10U);
  EXPECT_EQ(window(10, 32).width, 90U);
  EXPECT_EQ(window(-40, 16).x_offset, 0U);
  EXPECT_EQ(window(-40, 16).width, 75U);  // d <= -25: right of x = 74 every match is outside
  for (const int min : {-5000, -64, 0, 64, 99, 100, 5000}) {
    for (const int count : {1, 16, 5000}) {
      const auto w = window(min, count);
      EXPECT_GT(w.width, 0U);
      EXPECT_LE(w.x_offset + w.width, 100U);
      EXPECT_EQ(w.y_offset, 0U);
      EXPECT_EQ(w.height, 4U);
    }
  }
}

TEST_F(DisparityMessage, ReadsBackWhatItWrote) {
  geometry_.cx_offset_px = 7.0;
  const auto message = toDisparityMessage(map_, header_, geometry_, {0, 32}, 1.0);
  const cv::Mat map = fromDisparityMessage(*message, geometry_, "seeds/disparity");
  EXPECT_FLOAT_EQ(map.at<float>(0, 0), 10.25F);
  EXPECT_TRUE(std::isnan(map.at<float>(1, 2)));
}

TEST_F(DisparityMessage, RefusesForeignDisparityImages) {
  auto message = *toDisparityMessage(map_, header_, geometry_, {0, 32}, 1.0);
  message.image.encoding = "mono8";
  expectContains(errorOf([&] { fromDisparityMessage(message, geometry_, "seeds/disparity"); }),
                 {"seeds/disparity", "'mono8'", "32FC1"});
}

TEST_F(DisparityMessage, Depth) {
  map_.at<float>(0, 5) = 0.0F;
  map_.at<float>(0, 6) = -3.0F;
  const auto depth = toDepthMessage(map_, header_, geometry_, {});
  EXPECT_EQ(depth->encoding, "32FC1");
  EXPECT_EQ(depth->header.frame_id, "left_optical");
  EXPECT_FLOAT_EQ(pixel(*depth, 0, 0), 60.0F / 10.25F);
  EXPECT_TRUE(std::isnan(pixel(*depth, 2, 1)));
  EXPECT_TRUE(std::isnan(pixel(*depth, 5, 0)));
  EXPECT_TRUE(std::isnan(pixel(*depth, 6, 0)));
}

TEST_F(DisparityMessage, DepthOfVergedCameras) {
  geometry_.cx_offset_px = -20.0;
  EXPECT_FLOAT_EQ(pixel(*toDepthMessage(map_, header_, geometry_, {}), 0, 0), 60.0F / 30.25F);
}

TEST_F(DisparityMessage, DepthLimits) {
  EXPECT_TRUE(std::isnan(pixel(*toDepthMessage(map_, header_, geometry_, {6.0, 0.0}), 0, 0)));
  EXPECT_TRUE(std::isnan(pixel(*toDepthMessage(map_, header_, geometry_, {0.0, 5.0}), 0, 0)));
  EXPECT_FALSE(std::isnan(pixel(*toDepthMessage(map_, header_, geometry_, {5.0, 6.0}), 0, 0)));
}

TEST_F(DisparityMessage, ImagesWithPaddedRows) {
  const cv::Mat wide(4, 50, CV_32FC1, cv::Scalar(0.5));
  const auto message = toImageMessage(wide(cv::Rect(3, 0, 20, 4)), header_);
  EXPECT_EQ(message->step, 80U);
  EXPECT_FLOAT_EQ(pixel(*message, 19, 3), 0.5F);
}

}  // namespace
}  // namespace fdp_stereo
