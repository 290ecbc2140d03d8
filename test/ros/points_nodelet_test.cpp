// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// fdp_stereo/points behind a matcher that this test plays.
#include <cmath>

#include <fdp_stereo/PointsConfig.h>
#include <gtest/gtest.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "point_params.hpp"
#include "points_graph.hpp"

namespace fdp_stereo {
namespace {

using sensor_msgs::LaserScan;
using sensor_msgs::PointCloud2;
using test::CameraOnBase;
using test::Inbox;
using test::LogLines;
using test::nextStamp;
using test::PointScene;
using test::PointsNodeletHost;
using test::waitUntil;

/// Publishes what a matcher does. optional: confidence and depth_error too.
class Matcher {
 public:
  explicit Matcher(const std::string& name, bool optional = true) : node_(name) {
    publishers_ = {node_.advertise<stereo_msgs::DisparityImage>("disparity", 5),
                   node_.advertise<sensor_msgs::CameraInfo>("left/camera_info", 5),
                   node_.advertise<sensor_msgs::Image>("left/image_rect", 5)};
    if (!optional) return;
    publishers_.push_back(node_.advertise<sensor_msgs::Image>("confidence", 5));
    publishers_.push_back(node_.advertise<sensor_msgs::Image>("depth_error", 5));
  }
  void publish(const PointFrame& frame) {
    publishers_[2].publish(frame.image);
    publishers_[1].publish(frame.info);
    publishers_[0].publish(frame.disparity);
    if (publishers_.size() < 4) return;
    publishers_[3].publish(frame.confidence);
    publishers_[4].publish(frame.depth_error);
  }
  std::uint32_t subscribers() const {
    std::uint32_t sum = 0;
    for (const ros::Publisher& publisher : publishers_) sum += publisher.getNumSubscribers();
    return sum;
  }
  bool waitForSubscribers(std::uint32_t count) const {
    return waitUntil([&] { return subscribers() == count; });
  }
  /// Sends a scene until something comes out of it; null after the time.
  template <typename Message>
  boost::shared_ptr<const Message> process(Inbox<Message>& output, PointScene scene = {}, double seconds = 20.0) {
    const ros::Time first = nextStamp();
    scene.stamp = first;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      publish(scene.frame());
      if (auto m = output.wait([&](const auto& o) { return o.header.stamp >= first; }, 0.3)) return m;
      scene.stamp = nextStamp();
    }
    return nullptr;
  }

 private:
  ros::NodeHandle node_;
  std::vector<ros::Publisher> publishers_;
};

std::size_t knownPoints(const PointCloud2& cloud) {
  std::size_t known = 0;
  for (sensor_msgs::PointCloud2ConstIterator<float> z(cloud, "z"); z != z.end(); ++z) known += std::isnan(*z) ? 0 : 1;
  return known;
}

TEST(PointsNodelet, NothingIsDoneWithoutASubscriber) {
  Matcher matcher("/lazy");
  PointsNodeletHost host("/lazy");
  ASSERT_TRUE(host.loaded());
  ros::WallDuration(0.5).sleep();
  EXPECT_EQ(matcher.subscribers(), 0U);
  for (const char* topic : {"points2", "free_space"}) {
    Inbox<PointCloud2> cloud(ros::NodeHandle("/lazy"), topic);
    EXPECT_TRUE(matcher.waitForSubscribers(5)) << topic;
    EXPECT_TRUE(matcher.process(cloud)) << topic;
    cloud.close();
    EXPECT_TRUE(matcher.waitForSubscribers(0)) << topic;
  }
}

TEST(PointsNodelet, ADisparityOfAnyMatcherIsEnough) {
  Matcher matcher("/plain", false);
  PointsNodeletHost host("/plain", {{"points_decimation", 4}, {"min_confidence", 0.5}});
  LogLines log;
  Inbox<PointCloud2> points(ros::NodeHandle("/plain"), "points2");
  Inbox<PointCloud2> free_space(ros::NodeHandle("/plain"), "free_space");
  ASSERT_TRUE(matcher.waitForSubscribers(3));
  const auto cloud = matcher.process(points);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->width, 40U);
  EXPECT_TRUE(matcher.process(free_space));
  EXPECT_NE(log.wait({"min_confidence = 0.5", "/plain/confidence"}), "");
}

TEST(PointsNodelet, AScanNeedsItsFrame) {
  Matcher matcher("/scanner");
  PointsNodeletHost host("/scanner", {{"scan_frame", "nowhere"}});
  LogLines log;
  Inbox<LaserScan> scan(ros::NodeHandle("/scanner"), "scan");
  Inbox<PointCloud2> points(ros::NodeHandle("/scanner"), "points2");
  ASSERT_TRUE(matcher.waitForSubscribers(5));
  EXPECT_TRUE(matcher.process(points)) << "points need no frame";
  EXPECT_NE(log.wait({"scan", "'left_optical'", "scan_frame 'nowhere'"}), "");
  EXPECT_EQ(scan.count(), 0U);
}

TEST(PointsNodelet, AScanInItsFrame) {
  CameraOnBase camera;
  Matcher matcher("/framed");
  PointsNodeletHost host("/framed");
  Inbox<LaserScan> scan(ros::NodeHandle("/framed"), "scan");
  ASSERT_TRUE(matcher.waitForSubscribers(5));
  const auto got = matcher.process(scan);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->header.frame_id, "base_link");
  EXPECT_NEAR(got->ranges[got->ranges.size() / 2], 20.0 / 9.0, 0.01);
}

struct BadFrame {
  std::function<void(PointFrame&)> spoil;
  std::vector<std::string> said;
};

TEST(PointsNodelet, BadFramesAreSaidAndRecoveredFrom) {
  Matcher matcher("/bad");
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics(ros::NodeHandle(), "/diagnostics");
  std::unique_ptr<PointsNodeletHost> host;
  int number = 0;
  for (const BadFrame& bad : test::badPointFrames<BadFrame>()) {
    if (number++ % 15 == 0) {  // it bounds its lines in the log
      host.reset();
      host = std::make_unique<PointsNodeletHost>("/bad");
    }
    LogLines log;
    Inbox<PointCloud2> points(ros::NodeHandle("/bad"), "points2");
    ASSERT_TRUE(matcher.process(points)) << "the good frame before the bad ones";
    for (int i = 0; i < 10; ++i) {
      PointScene scene;
      scene.stamp = nextStamp();
      PointFrame frame = scene.frame();
      bad.spoil(frame);
      matcher.publish(frame);
      ros::WallDuration(0.003).sleep();
    }
    EXPECT_NE(log.wait(bad.said, 10.0), "") << bad.said[0];
    EXPECT_TRUE(diagnostics.wait(
        [&](const auto& array) {
          for (const auto& status : array.status) {
            if (status.level == diagnostic_msgs::DiagnosticStatus::ERROR &&
                status.message.find(bad.said.back()) != std::string::npos)
              return true;
          }
          return false;
        },
        10.0))
        << bad.said[0];
    EXPECT_TRUE(matcher.process(points)) << "recovers";
  }
}

TEST(PointsNodelet, ParametersCanBeChangedLive) {
  CameraOnBase camera;
  Matcher matcher("/live");
  PointsNodeletHost host("/live", {{"points_decimation", 2}});
  Inbox<PointCloud2> points(ros::NodeHandle("/live"), "points2");
  Inbox<LaserScan> scan(ros::NodeHandle("/live"), "scan");
  ASSERT_TRUE(matcher.waitForSubscribers(5));
  ASSERT_EQ(matcher.process(points)->width, 80U) << "as it was started";
  host.edit("points_decimation", 4);
  EXPECT_EQ(matcher.process(points)->width, 40U);
  EXPECT_EQ(host.edit("points_decimation", 1000), 64) << "clamped";
  EXPECT_GT(knownPoints(*matcher.process(points)), 0U);
  host.edit("points_decimation", 1);
  const std::size_t all = knownPoints(*matcher.process(points));
  const std::map<std::string, double> limits{{"max_depth_error", 1e-6}, {"max_depth", 0.5}};
  for (const auto& [name, value] : limits) {
    host.edit(name, value);
    EXPECT_EQ(knownPoints(*matcher.process(points)), 0U) << name;
    host.edit(name, 0.0);
    EXPECT_EQ(knownPoints(*matcher.process(points)), all) << name;
  }
  host.edit("scan_range_max", 7.0);
  EXPECT_FLOAT_EQ(matcher.process(scan)->range_max, 7.0F);
}

TEST(PointsNodelet, LiveEditsThatDoNotGoTogetherAreSaidAndReplaced) {
  LogLines log;
  PointsNodeletHost host("/edits");
  EXPECT_EQ(host.edit("scan_range_min", 50.0), 0.1);
  EXPECT_NE(log.wait({"~scan_range_min = 50", "below ~scan_range_max = 5"}, 5.0), "");
  EXPECT_EQ(host.edit("min_confidence", 7.0), 1.0);
  EXPECT_EQ(host.edit("max_depth", std::nan("")), 0.0);
  double written = 7.0;
  EXPECT_TRUE(ros::param::get("/edits/points_nodelet/max_depth", written));
  EXPECT_EQ(written, 0.0);
}

/// What rqt shows before anything is set.
TEST(PointsNodelet, TheDefaultsOfTheCfgFileAreThoseOfTheCode) {
  const PointsConfig cfg = PointsConfig::__getDefault__();
  const PointsConfig code = liveConfig({});
  for (const auto& description : PointsConfig::__getParamDescriptions__()) {
    boost::any ours, theirs;
    description->getValue(cfg, theirs);
    description->getValue(code, ours);
    if (description->type == "int") {
      EXPECT_EQ(boost::any_cast<int>(ours), boost::any_cast<int>(theirs)) << description->name;
    } else {
      EXPECT_EQ(boost::any_cast<double>(ours), boost::any_cast<double>(theirs)) << description->name;
    }
  }
}

TEST(PointsNodelet, BadParametersAreSaidAndReplaced) {
  struct Bad {
    std::string name;
    XmlRpc::XmlRpcValue value;
    std::vector<std::string> said;
  };
  const std::vector<Bad> table = {
      {"points_decimation", 0, {"~points_decimation = 0", "1 to 64", "using 1"}},
      {"points_decimation", 1000, {"~points_decimation = 1000"}},
      {"points_decimation", "two", {"~points_decimation", "no number"}},
      {"min_confidence", 1.5, {"~min_confidence = 1.5", "0 to 1"}},
      {"max_depth_error", -1.0, {"~max_depth_error = -1"}},
      {"max_depth", std::nan(""), {"~max_depth = nan"}},
      {"scan_frame", "", {"~scan_frame", "base_link"}},
      {"scan_frame", 3, {"~scan_frame", "base_link"}},
      {"scan_max_height", -5.0, {"~scan_min_height = 0.1", "below ~scan_max_height = -5"}},
      {"scan_range_min", 50.0, {"~scan_range_min = 50", "below ~scan_range_max"}},
      {"scan_range_max", 0.0, {"~scan_range_max = 0", "using 5"}},
      {"scan_angle_increment", 1e-9, {"~scan_angle_increment"}},
      {"queue_size", -1, {"~queue_size = -1", "using 60"}},
      {"diagnostic_period", 0.0, {"~diagnostic_period = 0"}},
      {"scan_heigth", 1.0, {"~scan_heigth", "no parameter"}},
  };
  Matcher matcher("/params");
  for (const Bad& bad : table) {
    LogLines log;
    PointsNodeletHost host("/params", {{bad.name, bad.value}});
    EXPECT_TRUE(host.loaded());
    EXPECT_NE(log.wait(bad.said, 5.0), "") << bad.name;
    Inbox<PointCloud2> points(ros::NodeHandle("/params"), "points2");
    EXPECT_TRUE(matcher.process(points)) << bad.name;
  }
}

TEST(PointsNodelet, HostileStampsDoNotStopIt) {
  Matcher matcher("/stamps");
  PointsNodeletHost host("/stamps");
  Inbox<PointCloud2> points(ros::NodeHandle("/stamps"), "points2");
  ASSERT_TRUE(matcher.waitForSubscribers(5));
  for (const std::uint32_t seconds : {0U, 1U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU, 3U}) {
    PointScene scene;
    scene.stamp = ros::Time(seconds, 5);
    matcher.publish(scene.frame());
    ros::WallDuration(0.01).sleep();
  }
  EXPECT_TRUE(matcher.process(points));
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "points_nodelet_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
