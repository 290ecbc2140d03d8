// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// process_bag IN.bag OUT.bag: the nodelet's outputs for every pair of a recording, without a roscore.
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <map>
#include <stdexcept>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <boost/make_shared.hpp>

#include "bag_pairs.hpp"
#include "bag_progress.hpp"
#include "bag_topics.hpp"
#include "command_line.hpp"
#include "compressed_image.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/out_of_memory.hpp"
#include "frame_processor.hpp"
#include "output_bag.hpp"
#include "rectifier.hpp"
#include "standing_calibration.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;
using sensor_msgs::CameraInfo;

constexpr char kImage[] = "sensor_msgs/Image";
constexpr char kCompressedImage[] = "sensor_msgs/CompressedImage";
constexpr char kCameraInfo[] = "sensor_msgs/CameraInfo";

struct Options {
  std::string input;
  std::string output;
  std::string preset = kDefaultPreset;
  std::string stereo_namespace = "/stereo";
  std::string image_name;
  StereoTopics topics{"", "", "", ""};
  std::string left_calibration;
  std::string right_calibration;
  bool rectify = false;
  bool rectified = false;
  bool overwrite = false;
  SyncOptions sync;
  PipelineOptions pipeline;
  MaskOptions masks;
};

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

/// The four topics as the recording spells them: raw images where both views have them, else compressed ones where
/// both have those. Throws where a topic is missing, and lists what there is.
StereoTopics findTopics(const Options& options, const BagTopics& bag) {
  const auto name = [&](const std::string& given, const std::string& below) {
    return given.empty() ? options.stereo_namespace + below : given;
  };
  const auto require = [&](const std::string& topic, const std::string& found) {
    if (!found.empty()) return found;
    throw std::runtime_error(options.input + ": has no messages on " + normalName(topic) + "; there are" + bag.list());
  };
  const std::string image = !options.image_name.empty() ? options.image_name
                            : options.rectify           ? "image_raw"
                                                        : "image_rect";
  const std::string left = name(options.topics.left_image, "/left/" + image);
  const std::string right = name(options.topics.right_image, "/right/" + image);
  const auto compressed = [&](const std::string& topic) {
    const std::string found = bag.find(topic + "/compressed", kCompressedImage);
    return found.empty() ? bag.find(topic, kCompressedImage) : found;
  };
  StereoTopics topics{bag.find(left, kImage), bag.find(right, kImage), "", ""};
  if (topics.left_image.empty() || topics.right_image.empty()) {
    const StereoTopics packed{compressed(left), compressed(right), "", ""};
    const bool both = !packed.left_image.empty() && !packed.right_image.empty();
    if (both || topics.left_image.empty()) topics.left_image = packed.left_image;
    if (both || topics.right_image.empty()) topics.right_image = packed.right_image;
  }
  require(left, topics.left_image);
  require(right, topics.right_image);
  const std::string left_info = name(options.topics.left_info, "/left/camera_info");
  const std::string right_info = name(options.topics.right_info, "/right/camera_info");
  topics.left_info = options.left_calibration.empty() ? require(left_info, bag.find(left_info, kCameraInfo))
                                                      : options.left_calibration;
  topics.right_info = options.right_calibration.empty() ? require(right_info, bag.find(right_info, kCameraInfo))
                                                        : options.right_calibration;
  return topics;
}

/// What is told at the end.
struct Counts {
  std::size_t pairs = 0;
  std::size_t refused = 0;
  std::size_t unmatched = 0;
  std::size_t replaced = 0;
  std::string first_problem;
  std::string silence;  ///< why there are no pairs
  std::map<std::string, std::size_t> warnings;
};

class BagProcessor {
 public:
  BagProcessor(const Options& options, const rosbag::Bag& input, rosbag::Bag& output)
      : options_(options),
        counts_of_topics_(input),
        topics_(findTopics(options, counts_of_topics_)),
        left_info_(input, counts_of_topics_, topics_.left_image, topics_.left_info, options.left_calibration),
        right_info_(input, counts_of_topics_, topics_.right_image, topics_.right_info, options.right_calibration),
        output_(output),
        pairs_(options.sync),
        processor_(
            topics_, nullptr, [this](cv::Size size) { return masks(size); },
            options.rectify ? InputImages::kRaw : InputImages::kRectified) {
    settings_.pipeline = resolveParams(options.preset, options.pipeline);
    for (const char* name : {"/disparity", "/depth", "/depth/image_rect", "/depth/camera_info", "/confidence"}) {
      results_.push_back(options.stereo_namespace + name);
    }
  }

  Counts run(rosbag::View& view) {
    BagProgress progress(view.size());
    std::size_t done = 0;
    for (const rosbag::MessageInstance& message : view) {
      ++done;
      if (std::find(results_.begin(), results_.end(), normalName(message.getTopic())) != results_.end()) {
        ++counts_.replaced;
        continue;
      }
      output_.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
      guarded([&] { add(message); });
      processPairs(message.getTime(), progress, done);
    }
    pairs_.finish();
    processPairs(view.getEndTime(), progress, done);
    counts_.unmatched = pairs_.imagesWithoutPartner();
    if (counts_.pairs + counts_.refused == 0) counts_.silence = pairs_.silence(topics_);
    return counts_;
  }

 private:
  /// What is wrong with one message or pair must not end the run.
  template <typename Call>
  void guarded(Call&& call) {
    std::string problem;
    try {
      return call();
    } catch (...) {
      problem = describeCurrentException();
    }
    if (counts_.refused++ == 0) counts_.first_problem = problem;
  }

  void add(const rosbag::MessageInstance& message) {
    const std::string& topic = message.getTopic();
    if (topic == topics_.left_image) addImage(message, kLeftImage);
    if (topic == topics_.right_image) addImage(message, kRightImage);
    if (topic == topics_.left_info) addInfo(message, kLeftInfo, left_info_);
    if (topic == topics_.right_info) addInfo(message, kRightInfo, right_info_);
  }

  void addImage(const rosbag::MessageInstance& message, Input side) {
    std_msgs::Header header;
    if (const auto image = message.instantiate<sensor_msgs::Image>()) {
      header = image->header;
    } else if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
      header = compressed->header;
    } else {
      throw std::runtime_error(message.getTopic() + ": a message is of another type than its topic");
    }
    const StandingCalibration& standing = side == kLeftImage ? left_info_ : right_info_;
    if (standing.inForce()) pairs_.addInfo(side == kLeftImage ? kLeftInfo : kRightInfo, standing.at(header));
    pairs_.addImage(side, boost::make_shared<const BagImage>(
                              BagImage{header.stamp, boost::make_shared<const rosbag::MessageInstance>(message)}));
  }

  void addInfo(const rosbag::MessageInstance& message, Input side, StandingCalibration& standing) {
    const auto info = message.instantiate<CameraInfo>();
    if (!info) throw std::runtime_error(message.getTopic() + ": a message is of another type than its topic");
    if (standing.inForce()) {
      standing.replace(info);
    } else {
      pairs_.addInfo(side, info);
    }
  }

  void processPairs(const ros::Time& time, BagProgress& progress, std::size_t done) {
    while (const auto pair = pairs_.take()) {
      requireRectified(*pair->left_info, topics_.left_image, topics_.left_info);
      requireRectified(*pair->right_info, topics_.right_image, topics_.right_info);
      FrameOutput results;
      guarded([&] { results = process(*pair); });
      if (results.disparity) write(results, time);
      progress.frame(done);
    }
  }

  FrameOutput process(const BagPair& pair) {
    StereoFrame frame;
    frame.left = read(*pair.left, *pair.left_info, topics_.left_image);
    frame.right = read(*pair.right, *pair.right_info, topics_.right_image);
    frame.left_info = pair.left_info;
    frame.right_info = pair.right_info;
    return processor_.process(frame, settings_, {true, true, true});
  }

  /// Raw images that are taken for rectified ones give wrong depth silently.
  void requireRectified(const CameraInfo& info, const std::string& image_topic, const std::string& info_topic) const {
    if (options_.rectify || options_.rectified || isRectifiedName(image_topic) || !needsRectification(info)) return;
    throw std::runtime_error(
        image_topic + ": by " + info_topic +
        " (D, R, K against P) a raw image differs from a rectified one, and its name does not tell "
        "which it is; use --rectify, or --rectified where it is rectified already");
  }

  MaskPair masks(cv::Size size) {
    const std::array<std::string, 2> paths{options_.masks.left, options_.masks.right};
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (masks_[i].size() != size) masks_[i] = readMask(paths[i], size);
    }
    return masks_;
  }

  static sensor_msgs::ImageConstPtr read(const BagImage& image, const CameraInfo& info, const std::string& topic) {
    constexpr std::int64_t kAlwaysAllowed = 1 << 24;  // px; more only where the calibration tells of them
    const std::int64_t max_pixels = std::max(kAlwaysAllowed, std::int64_t{info.width} * info.height);
    if (auto read = image.message->instantiate<sensor_msgs::Image>()) return read;
    return decompress(*image.message->instantiate<sensor_msgs::CompressedImage>(), topic, max_pixels);
  }

  void write(const FrameOutput& results, const ros::Time& time) {
    const std::string& base = options_.stereo_namespace;
    output_.write(base + "/disparity", time, results.disparity);
    output_.write(base + "/depth", time, results.depth);  // the name of version 0.1.0
    output_.write(base + "/depth/image_rect", time, results.depth);
    output_.write(base + "/depth/camera_info", time, results.depth_info);
    output_.write(base + "/confidence", time, results.confidence);
    for (const std::string& warning : results.report.warnings) ++counts_.warnings[warning];
    ++counts_.pairs;
  }

  const Options& options_;
  BagTopics counts_of_topics_;
  StereoTopics topics_;
  StandingCalibration left_info_, right_info_;
  rosbag::Bag& output_;
  PairCollector pairs_;
  FrameProcessor processor_;
  MaskPair masks_;
  NodeSettings settings_;
  std::vector<std::string> results_;  ///< topics that are written here
  Counts counts_;
};

void report(const Options& options, const Counts& counts) {
  constexpr int kMostWarnings = 10;
  std::cout << options.output << ": " << counts.pairs << " disparity images, " << counts.refused << " pairs refused, "
            << counts.unmatched << " images without a partner\n";
  if (counts.replaced > 0) std::cout << counts.replaced << " messages of earlier results were replaced\n";
  if (counts.refused > 0) std::cerr << "process_bag: the first pair that was refused: " << counts.first_problem << '\n';
  int told = 0;
  for (const auto& [warning, times] : counts.warnings) {
    if (told++ < kMostWarnings) std::cerr << "process_bag: warning (" << times << " pairs): " << warning << '\n';
  }
  if (told > kMostWarnings) std::cerr << "process_bag: " << told - kMostWarnings << " other warnings\n";
}

int processBag(Options& options) {
  if (options.left_calibration.empty() != options.right_calibration.empty()) {
    throw UsageError("--left-calibration and --right-calibration go together");
  }
  if (options.rectify && options.rectified) throw UsageError("--rectify is for raw images, --rectified for others");
  options.stereo_namespace = normalName(options.stereo_namespace);
  checkOutputs({options.output},
               {options.input, options.preset, options.left_calibration, options.right_calibration, options.masks.left,
                options.masks.right},
               options.overwrite);
  rosbag::Bag input;
  openInput(input, options.input);
  OutputBag output(options.output);
  output->setCompression(rosbag::compression::LZ4);
  BagProcessor processor(options, input, *output);
  rosbag::View view(input);
  Counts counts;
  try {
    counts = processor.run(view);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error("copying " + options.input + " to " + options.output + ": " + error.what());
  }
  if (!counts.silence.empty()) throw std::runtime_error(options.input + ": no pairs: " + counts.silence);
  if (counts.pairs == 0) throw std::runtime_error("every pair was refused, the first: " + counts.first_problem);
  output.finish();
  report(options, counts);
  return 0;
}

void addInputOptions(CLI::App& app, Options& options) {
  app.add_option("--namespace", options.stereo_namespace, "Namespace of the camera, and of the outputs")
      ->capture_default_str();
  app.add_option("--image-name", options.image_name,
                 "Name of the images below left and right (default image_rect, with --rectify image_raw); of raw and "
                 "compressed ones the raw are taken");
  app.add_option("--left", options.topics.left_image, "Topic of the left image, instead of NAMESPACE/left/IMAGE-NAME");
  app.add_option("--right", options.topics.right_image, "Topic of the right image");
  app.add_option("--left-info", options.topics.left_info, "Topic of the left camera_info");
  app.add_option("--right-info", options.topics.right_info, "Topic of the right camera_info");
  app.add_option("--left-calibration", options.left_calibration,
                 "Calibration file (YAML of camera_calibration) instead of the left camera_info");
  app.add_option("--right-calibration", options.right_calibration, "The same for the right camera");
  app.add_flag("--rectify", options.rectify,
               "The images are raw: rectify them first, as image_proc does, and leave out the border that this makes");
  app.add_flag("--rectified", options.rectified, "The images are rectified, although their name does not say so");
  app.add_flag("--approximate-sync", options.sync.approximate, "Pair images whose stamps differ, like the node");
  app.add_option("--approximate-sync-tolerance", options.sync.tolerance_s, "Largest difference in s, 0 = any")
      ->check(numberIn(0.0, 60.0));
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("IN", options.input, "Recording with images and camera_info of both views")->required();
  app.add_option("OUT", options.output, "Bag to write: all of IN, and disparity, depth and confidence")->required();
  app.add_option("--preset", options.preset, "Preset by name, or a YAML file")->capture_default_str();
  addPipelineOptions(app, options.pipeline);
  addMaskOptions(app, options.masks);
  addInputOptions(app, options);
  addOverwriteOption(app, options.overwrite);
  app.footer("Exit codes: 0 done, 1 the recording is at fault, 2 the command line is.");
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Disparity, depth and confidence for every pair of a recording", "process_bag");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::processBag(options); });
}
