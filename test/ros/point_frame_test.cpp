// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_frame.hpp"

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

namespace fdp_stereo {
namespace {

using Needs = PointFrameCollector::Needs;

/// Adds messages without content.
class PointFrames : public ::testing::Test {
 protected:
  std::optional<PointFrame> disparity(double t) {
    auto message = boost::make_shared<stereo_msgs::DisparityImage>();
    message->header.stamp = ros::Time(t);
    return collector_.add(&PointFrame::disparity, 0, stereo_msgs::DisparityImageConstPtr(message), ros::Time(t),
                          needs_);
  }
  std::optional<PointFrame> info(double t) {
    return collector_.add(&PointFrame::info, 1,
                          sensor_msgs::CameraInfoConstPtr(boost::make_shared<sensor_msgs::CameraInfo>()), ros::Time(t),
                          needs_);
  }
  std::optional<PointFrame> image(double t) { return add(&PointFrame::image, 2, t); }
  std::optional<PointFrame> confidence(double t) { return add(&PointFrame::confidence, 3, t); }

  Needs needs_;
  PointFrameCollector collector_{4};

 private:
  std::optional<PointFrame> add(sensor_msgs::ImageConstPtr PointFrame::*part, std::size_t topic, double t) {
    return collector_.add(part, topic, sensor_msgs::ImageConstPtr(boost::make_shared<sensor_msgs::Image>()),
                          ros::Time(t), needs_);
  }
};

TEST_F(PointFrames, TheLastPartCompletesAFrame) {
  EXPECT_FALSE(image(1.0));
  EXPECT_FALSE(image(2.0)) << "images come long before their disparity";
  EXPECT_FALSE(info(1.0));
  const auto frame = disparity(1.0);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->disparity->header.stamp, ros::Time(1.0));
  EXPECT_FALSE(frame->confidence);
  EXPECT_FALSE(info(2.0));
  EXPECT_TRUE(disparity(2.0));
}

TEST_F(PointFrames, WithoutAnImageWhereNoneIsWanted) {
  needs_.image = false;
  EXPECT_FALSE(info(1.0));
  EXPECT_TRUE(disparity(1.0));
}

TEST_F(PointFrames, ConfidenceIsWaitedForUntilTheNextFrame) {
  needs_.image = false;
  needs_.confidence = true;
  info(1.0);
  EXPECT_FALSE(disparity(1.0));
  const auto with = confidence(1.0);
  ASSERT_TRUE(with);
  EXPECT_TRUE(with->confidence);
  info(2.0);
  EXPECT_FALSE(disparity(2.0));
  info(3.0);
  const auto without = disparity(3.0);
  ASSERT_TRUE(without) << "its publisher says nothing";
  EXPECT_EQ(without->disparity->header.stamp, ros::Time(2.0));
  EXPECT_FALSE(without->confidence);
}

TEST_F(PointFrames, FramesThatStayIncompleteAreForgotten) {
  for (int i = 1; i < 100; ++i) EXPECT_FALSE(image(i));
  info(1.0);
  EXPECT_FALSE(disparity(1.0)) << "its image is long gone";
}

TEST_F(PointFrames, ABagThatStartsAgain) {
  for (const double t : {10.0, 1.0}) {
    image(t);
    info(t);
    EXPECT_TRUE(disparity(t)) << t;
  }
}

}  // namespace
}  // namespace fdp_stereo
