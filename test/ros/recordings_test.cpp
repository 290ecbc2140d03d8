// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Recordings of raw pairs through image_proc and the nodelet of stereo.launch, and then, as rectified by image_proc,
// through process_bag: both must give the same disparities.
// With FDP_STEREO_PICTURES=FOLDER three disparities of each recording are written there.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;
using sensor_msgs::Image;
using stereo_msgs::DisparityImage;
using stereo_msgs::DisparityImageConstPtr;
using test::Inbox;

constexpr std::size_t kMessagesOfAPair = 4;  // they follow each other in the bags of images_to_bag

void runTool(const std::string& arguments) {
  const std::string command = FDP_STEREO_TOOL_DIR "/" + arguments;
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// A folder that goes with the test.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name) : path_(fs::temp_directory_path() / name) {
    fs::remove_all(path_);
    fs::create_directory(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// One publisher per topic of the bag.
class Player {
 public:
  explicit Player(rosbag::View& view) {
    for (const auto* connection : view.getConnections()) {
      ros::AdvertiseOptions options(connection->topic, 10, connection->md5sum, connection->datatype,
                                    connection->msg_def);
      publishers_[connection->topic] = node_.advertise(options);
    }
  }
  void publish(const rosbag::MessageInstance& message) { publishers_.at(message.getTopic()).publish(message); }
  bool connected() const {
    return std::all_of(publishers_.begin(), publishers_.end(),
                       [](const auto& entry) { return entry.second.getNumSubscribers() > 0; });
  }

 private:
  ros::NodeHandle node_;
  std::map<std::string, ros::Publisher> publishers_;
};

void writePicture(const DisparityImage& message, const std::string& name) {
  const char* folder = std::getenv("FDP_STEREO_PICTURES");
  if (folder == nullptr) return;
  const cv::Mat map = fromDisparityMessage(message, {}, "disparity");
  const int min = static_cast<int>(message.min_disparity);
  const DisparityRange range{min, static_cast<int>(message.max_disparity) - min + 1};
  writeImage(std::string(folder) + "/" + name + ".png", colorize(map, range));
}

/// Plays the bag pair by pair, so that none is dropped; writes the rectified pairs into another bag. Returns what the
/// nodelet made of each pair.
std::vector<DisparityImageConstPtr> playThroughNodelet(const std::string& name, const std::string& raw,
                                                       const std::string& rectified) {
  rosbag::Bag bag(raw);
  rosbag::View view(bag);
  Player player(view);
  const ros::NodeHandle node("/" + name);
  Inbox<Image> left(node, "left/image_rect");
  Inbox<Image> right(node, "right/image_rect");
  Inbox<DisparityImage> inbox(node, "disparity");
  const auto ready = [&] {
    return inbox.publishers() == 1 && left.publishers() == 1 && right.publishers() == 1 && player.connected();
  };
  EXPECT_TRUE(test::waitUntil(ready, 60.0));

  rosbag::Bag output(rectified, rosbag::bagmode::Write);
  std::vector<DisparityImageConstPtr> disparities;
  std::size_t in_pair = 0;
  for (const auto& message : view) {
    player.publish(message);
    if (message.isType<sensor_msgs::CameraInfo>()) output.write(message.getTopic(), message.getTime(), message);
    if (++in_pair % kMessagesOfAPair != 0) continue;
    const ros::Time stamp = message.getTime();
    const auto fits = [&](const auto& m) { return m.header.stamp == stamp; };
    disparities.push_back(inbox.wait(fits, 30.0));
    const auto left_image = left.wait(fits);
    const auto right_image = right.wait(fits);
    if (!disparities.back() || !left_image || !right_image) {
      ADD_FAILURE() << name << ": no answer to pair " << disparities.size();
      return {};
    }
    output.write("/" + name + "/left/image_rect", stamp, left_image);
    output.write("/" + name + "/right/image_rect", stamp, right_image);
    if ((disparities.size() - 1) % 9 == 0) {
      writePicture(*disparities.back(), name + "_" + std::to_string(disparities.size() - 1));
    }
  }
  return disparities;
}

/// Every byte of the message; the sequence number is the publisher's.
std::vector<std::uint8_t> bytes(DisparityImage message) {
  message.header.seq = message.image.header.seq = 0;
  std::vector<std::uint8_t> buffer(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(buffer.data(), static_cast<std::uint32_t>(buffer.size()));
  ros::serialization::serialize(stream, message);
  return buffer;
}

void expectProcessBagGives(const std::vector<DisparityImageConstPtr>& expected, const std::string& name,
                           const TemporaryFolder& folder) {
  runTool("process_bag " + folder.file("rectified.bag") + " " + folder.file("processed.bag") + " --namespace /" + name +
          " --set row_alignment.mode=per_frame");
  rosbag::Bag bag(folder.file("processed.bag"));
  rosbag::View view(bag, rosbag::TopicQuery("/" + name + "/disparity"));
  ASSERT_EQ(view.size(), expected.size());
  std::size_t pair = 0;
  for (const auto& message : view) {
    const auto disparity = message.instantiate<DisparityImage>();
    ASSERT_TRUE(disparity);
    EXPECT_TRUE(bytes(*disparity) == bytes(*expected[pair])) << "pair " << pair;
    ++pair;
  }
}

TEST(Recordings, TwentyPairsOfAFlyingRobot) {
  const std::string data = FDP_STEREO_SOURCE_DIR "/../shared/data/EuRoC-V1_01";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const TemporaryFolder folder("fdp_stereo_euroc_test");
  runTool("images_to_bag --namespace /euroc --left " + data + "/mav0/cam0/data --right " + data +
          "/mav0/cam1/data --left-info " + data + "/left.yaml --right-info " + data + "/right.yaml --timestamps " +
          data + "/timestamps.txt --output " + folder.file("raw.bag"));
  const auto disparities = playThroughNodelet("euroc", folder.file("raw.bag"), folder.file("rectified.bag"));
  ASSERT_EQ(disparities.size(), 20U);
  for (std::size_t pair = 0; pair < disparities.size(); ++pair) {
    EXPECT_EQ(disparities[pair]->image.width, 752U);
    EXPECT_EQ(disparities[pair]->header.frame_id, "stereo_optical");
    EXPECT_NEAR(disparities[pair]->T, 0.11, 0.01);
    const cv::Mat map = fromDisparityMessage(*disparities[pair], {}, "disparity");
    EXPECT_GT(cv::countNonZero(map == map), map.total() * 2 / 5) << "pair " << pair;
  }
  expectProcessBagGives(disparities, "euroc", folder);
}

TEST(Recordings, Sample) {
  const TemporaryFolder folder("fdp_stereo_sample_test");
  const std::string pair = FDP_STEREO_SOURCE_DIR "/sample/motorcycle/";
  runTool("images_to_bag --namespace /sample --left " + pair + "left.png --right " + pair + "right.png --left-info " +
          pair + "left.yaml --right-info " + pair + "right.yaml --rate 2 --repeat 3 --output " +
          folder.file("raw.bag"));
  const auto disparities = playThroughNodelet("sample", folder.file("raw.bag"), folder.file("rectified.bag"));
  ASSERT_EQ(disparities.size(), 3U);
  const cv::Mat map = fromDisparityMessage(*disparities[0], {}, "disparity");
  EXPECT_GT(cv::countNonZero(map == map), map.total() * 3 / 4);
  expectProcessBagGives(disparities, "sample", folder);
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "recordings_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
