// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// process_bag IN.bag OUT.bag: the nodelet's outputs for every rectified pair of a recording, without a roscore.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <stdexcept>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <unistd.h>
#include <opencv2/imgcodecs.hpp>

#include "command_line.hpp"
#include "conversions.hpp"
#include "frame_processor.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxWaiting = 200;  // messages of one topic that wait for their partners
constexpr int kMaxNamedTopics = 20;

struct Options {
  std::string input;
  std::string output;
  std::string preset = kDefaultPreset;
  std::string stereo_namespace = "/stereo";
  std::string image_name = "image_rect";
  StereoTopics topics{"", "", "", ""};
  bool overwrite = false;
  PipelineOptions pipeline;
};

StereoTopics resolveTopics(const Options& options) {
  const auto topic = [&](const std::string& given, const char* side, const std::string& name) {
    return given.empty() ? options.stereo_namespace + "/" + side + "/" + name : given;
  };
  return {topic(options.topics.left_image, "left", options.image_name),
          topic(options.topics.right_image, "right", options.image_name),
          topic(options.topics.left_info, "left", "camera_info"),
          topic(options.topics.right_info, "right", "camera_info")};
}

/// Opens a recording; says what to do where it was not closed.
void openInput(rosbag::Bag& bag, const std::string& path) {
  if (!fs::is_regular_file(path)) throw std::runtime_error(path + ": no such file");
  try {
    bag.open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw std::runtime_error(path + ": was cut off or not closed and has no index; run 'rosbag reindex' on it first");
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

/// Throws where a topic is missing, and lists what there is.
void requireTopics(rosbag::View& view, const StereoTopics& topics, const std::string& path) {
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : view.getConnections())
    types[connection->topic] = connection->datatype;
  for (const std::string& topic : {topics.left_image, topics.right_image, topics.left_info, topics.right_info}) {
    if (types.count(topic) > 0 || types.count(topic + "/compressed") > 0) continue;
    std::string message = path + ": has no messages on " + topic + "; there are";
    int named = 0;
    for (const auto& [name, type] : types) {
      if (named++ < kMaxNamedTopics) message += " " + name + " (" + type + ")";
    }
    throw std::runtime_error(message);
  }
}

/// An Image, or a CompressedImage decoded; null for a message of another type.
sensor_msgs::ImageConstPtr imageOf(const rosbag::MessageInstance& message) {
  if (const auto image = message.instantiate<sensor_msgs::Image>()) return image;
  const auto compressed = message.instantiate<sensor_msgs::CompressedImage>();
  if (!compressed) return nullptr;
  cv::Mat decoded;
  if (!compressed->data.empty()) decoded = cv::imdecode(compressed->data, cv::IMREAD_UNCHANGED);
  if (decoded.empty()) throw std::invalid_argument(message.getTopic() + ": not readable as a compressed image");
  return toImageMessage(decoded, compressed->header);
}

/// Puts images and calibrations of one stamp together.
class PairCollector {
 public:
  explicit PairCollector(StereoTopics topics) : topics_(std::move(topics)) {}

  /// True and `frame` filled when the message completes a pair.
  bool add(const rosbag::MessageInstance& message, StereoFrame& frame) {
    const std::string& topic = message.getTopic();
    const auto is = [&](const std::string& name) { return topic == name || topic == name + "/compressed"; };
    if (is(topics_.left_image)) return addImage(message, true, frame);
    if (is(topics_.right_image)) return addImage(message, false, frame);
    if (topic == topics_.left_info) return addInfo(message, true, frame);
    if (topic == topics_.right_info) return addInfo(message, false, frame);
    return false;
  }
  /// Images that found no partner.
  std::size_t unmatched() const { return unmatched_ + waiting_.size(); }

 private:
  bool addImage(const rosbag::MessageInstance& message, bool left, StereoFrame& frame) {
    const auto image = imageOf(message);
    if (!image) return false;
    (left ? waiting_[image->header.stamp].left : waiting_[image->header.stamp].right) = image;
    return complete(image->header.stamp, frame);
  }

  bool addInfo(const rosbag::MessageInstance& message, bool left, StereoFrame& frame) {
    const auto info = message.instantiate<sensor_msgs::CameraInfo>();
    if (!info) return false;
    (left ? waiting_[info->header.stamp].left_info : waiting_[info->header.stamp].right_info) = info;
    return complete(info->header.stamp, frame);
  }

  bool complete(const ros::Time& stamp, StereoFrame& frame) {
    const auto found = waiting_.find(stamp);
    const StereoFrame& candidate = found->second;
    const bool whole = candidate.left && candidate.right && candidate.left_info && candidate.right_info;
    if (whole) {
      frame = candidate;
      waiting_.erase(found);
    } else if (waiting_.size() > kMaxWaiting) {
      ++unmatched_;
      waiting_.erase(waiting_.begin());
    }
    return whole;
  }

  StereoTopics topics_;
  std::map<ros::Time, StereoFrame> waiting_;
  std::size_t unmatched_ = 0;
};

/// Frames, rate and time left; a line that is rewritten on a terminal, silent elsewhere.
class BagProgress {
 public:
  explicit BagProgress(std::size_t messages) : messages_(std::max<std::size_t>(1, messages)) {}
  ~BagProgress() {
    if (terminal_ && frames_ > 0) std::fputc('\n', stderr);
  }
  BagProgress(const BagProgress&) = delete;
  BagProgress& operator=(const BagProgress&) = delete;

  void frame(std::size_t messages_done) {
    ++frames_;
    if (!terminal_) return;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double share = static_cast<double>(messages_done) / static_cast<double>(messages_);
    std::fprintf(stderr, "\r%zu frames, %.1f Hz, %.0f %%, %.0f s left\x1b[K", frames_,
                 static_cast<double>(frames_) / seconds, 100.0 * share,
                 seconds * (1.0 - share) / std::max(share, 1e-6));
  }

 private:
  std::size_t messages_;
  std::size_t frames_ = 0;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Refuses images that still have to be rectified: their disparity would be silently wrong.
void requireRectified(const sensor_msgs::CameraInfo& info, const std::string& image_topic) {
  const auto distorted = std::any_of(info.D.begin(), info.D.end(), [](double d) { return std::abs(d) > 1e-9; });
  const std::string raw = "image_raw";
  const bool named_raw =
      image_topic.size() >= raw.size() && image_topic.compare(image_topic.size() - raw.size(), raw.size(), raw) == 0;
  if (distorted && named_raw) {
    throw std::runtime_error(image_topic +
                             ": its calibration has distortion, rectify the recording first (image_proc)");
  }
}

struct Counts {
  std::size_t pairs = 0;
  std::size_t refused = 0;
  std::size_t unmatched = 0;
  std::string first_problem;
};

void writeOutputs(rosbag::Bag& bag, const std::string& base, const ros::Time& time, const FrameOutput& output) {
  bag.write(base + "/disparity", time, output.disparity);
  bag.write(base + "/depth", time, output.depth);
  bag.write(base + "/depth/camera_info", time, output.depth_info);
  bag.write(base + "/confidence", time, output.confidence);
}

Counts processMessages(const Options& options, const NodeSettings& settings, rosbag::View& view, rosbag::Bag& output) {
  const StereoTopics topics = resolveTopics(options);
  PairCollector pairs(topics);
  FrameProcessor processor(topics);
  BagProgress progress(view.size());
  Counts counts;
  std::size_t done = 0;
  for (const rosbag::MessageInstance& message : view) {
    ++done;
    output.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
    StereoFrame frame;
    try {
      if (!pairs.add(message, frame)) continue;
      if (counts.pairs == 0) requireRectified(*frame.left_info, topics.left_image);
      writeOutputs(output, options.stereo_namespace, message.getTime(),
                   processor.process(frame, settings, {true, true, true}));
      ++counts.pairs;
    } catch (const std::invalid_argument& error) {
      if (counts.refused++ == 0) counts.first_problem = error.what();
    }
    progress.frame(done);
  }
  counts.unmatched = pairs.unmatched();
  return counts;
}

int report(const Options& options, const Counts& counts) {
  std::cout << options.output << ": " << counts.pairs << " disparity images, " << counts.refused << " pairs refused, "
            << counts.unmatched << " stamps without a whole pair\n";
  if (counts.refused > 0) std::cerr << "process_bag: the first pair that was refused: " << counts.first_problem << '\n';
  return counts.pairs > 0 ? 0 : 1;
}

int processBag(const Options& options) {
  NodeSettings settings;
  settings.pipeline = resolveParams(options.preset, options.pipeline);
  rosbag::Bag input;
  openInput(input, options.input);
  if (fs::exists(options.output) && !options.overwrite) {
    throw std::runtime_error(options.output + ": exists already, give another name or --overwrite");
  }
  rosbag::View view(input);
  requireTopics(view, resolveTopics(options), options.input);
  // Under another name until it is whole: an interrupted run leaves nothing that looks finished.
  const std::string partial = options.output + ".active";
  rosbag::Bag output(partial, rosbag::bagmode::Write);
  output.setCompression(rosbag::compression::LZ4);
  const Counts counts = processMessages(options, settings, view, output);
  output.close();
  fs::rename(partial, options.output);
  return report(options, counts);
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("IN", options.input, "Recording with rectified images and camera_info of both views")->required();
  app.add_option("OUT", options.output, "Bag to write: all of IN, and disparity, depth and confidence")->required();
  app.add_option("--preset", options.preset, "Preset by name, or a YAML file")->capture_default_str();
  addPipelineOptions(app, options.pipeline);
  app.add_option("--namespace", options.stereo_namespace, "Namespace of the camera, and of the outputs")
      ->capture_default_str();
  app.add_option("--image-name", options.image_name,
                 "Name of the images below left and right; compressed ones count too")
      ->capture_default_str();
  app.add_option("--left", options.topics.left_image, "Topic of the left image, instead of NAMESPACE/left/IMAGE-NAME");
  app.add_option("--right", options.topics.right_image, "Topic of the right image");
  app.add_option("--left-info", options.topics.left_info, "Topic of the left camera_info");
  app.add_option("--right-info", options.topics.right_info, "Topic of the right camera_info");
  app.add_flag("--overwrite", options.overwrite, "Replace OUT where it exists");
  app.footer("Exit codes: 0 done, 1 the recording is at fault, 2 the command line is.");
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Disparity, depth and confidence for every rectified pair of a recording", "process_bag");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::processBag(options); });
}
