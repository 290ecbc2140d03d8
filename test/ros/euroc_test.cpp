// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Twenty raw pairs of a flying robot: images_to_bag, then image_proc and the nodelet from stereo.launch.
// With FDP_STEREO_PICTURES=FOLDER three of the disparities are written there.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "nodelet_graph.hpp"

namespace fdp_stereo {
namespace {

const std::string kData = FDP_STEREO_SOURCE_DIR "/../shared/data/EuRoC-V1_01";

void makeBag(const std::string& bag) {
  const std::string command = FDP_STEREO_TOOL_DIR "/images_to_bag --left " + kData + "/mav0/cam0/data --right " +
                              kData + "/mav0/cam1/data --left-info " + kData + "/left.yaml --right-info " + kData +
                              "/right.yaml --timestamps " + kData + "/timestamps.txt --output " + bag;
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// One publisher per topic of the bag.
class Player {
 public:
  void publish(const rosbag::MessageInstance& message) { publishers_.at(message.getTopic()).publish(message); }
  void advertise(rosbag::View& view) {
    for (const auto* connection : view.getConnections()) {
      ros::AdvertiseOptions options(connection->topic, 10, connection->md5sum, connection->datatype,
                                    connection->msg_def);
      publishers_[connection->topic] = node_.advertise(options);
    }
  }
  bool connected() const {
    return std::all_of(publishers_.begin(), publishers_.end(),
                       [](const auto& entry) { return entry.second.getNumSubscribers() > 0; });
  }

 private:
  ros::NodeHandle node_;
  std::map<std::string, ros::Publisher> publishers_;
};

/// Beside each other: what was published, in colours.
void writePicture(const stereo_msgs::DisparityImage& message, int number) {
  const char* folder = std::getenv("FDP_STEREO_PICTURES");
  if (folder == nullptr) return;
  const cv::Mat map = fromDisparityMessage(message, {}, "disparity");
  const int min = static_cast<int>(message.min_disparity);
  const DisparityRange range{min, static_cast<int>(message.max_disparity) - min + 1};
  writeImage(std::string(folder) + "/euroc_" + std::to_string(number) + ".png", colorize(map, range));
}

TEST(EuRoC, EverySynchronisedPairGivesADisparity) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << kData << " is not there";
  const std::string path = (std::filesystem::temp_directory_path() / "fdp_stereo_euroc_test.bag").string();
  makeBag(path);
  rosbag::Bag bag(path);
  rosbag::View view(bag);
  Player player;
  player.advertise(view);
  test::Inbox<stereo_msgs::DisparityImage> inbox(ros::NodeHandle("/stereo"), "disparity");
  ASSERT_TRUE(test::waitUntil([&] { return inbox.publishers() == 1 && player.connected(); }, 60.0));

  std::size_t in_pair = 0;
  int pairs = 0;
  for (const auto& message : view) {
    player.publish(message);
    if (++in_pair % 4 != 0) continue;  // the four topics of a pair follow each other
    const ros::Time stamp = message.getTime();
    const auto disparity = inbox.wait([&](const auto& d) { return d.header.stamp == stamp; }, 30.0);
    ASSERT_TRUE(disparity) << "pair " << pairs;
    EXPECT_EQ(disparity->image.width, 752U);
    EXPECT_EQ(disparity->header.frame_id, "stereo_optical");
    EXPECT_NEAR(disparity->T, 0.11, 0.01);
    const cv::Mat map = fromDisparityMessage(*disparity, {}, "disparity");
    EXPECT_GT(cv::countNonZero(map == map), map.total() * 2 / 5) << "pair " << pairs;
    if (pairs % 9 == 0) writePicture(*disparity, pairs);
    ++pairs;
  }
  EXPECT_EQ(pairs, 20);
  bag.close();
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "euroc_test");
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
