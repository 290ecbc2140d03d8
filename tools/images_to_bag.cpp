// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Images and calibration files of a stereo camera to a bag with image_raw and camera_info of both views.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "bag_topics.hpp"
#include "calibration_file.hpp"
#include "command_line.hpp"
#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "output_bag.hpp"
#include "stamps.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> left;
  std::vector<std::string> right;
  std::string left_info;
  std::string right_info;
  std::string timestamps;
  std::string output;
  std::string stereo_namespace = "/stereo";
  std::string frame_id = "stereo_optical";
  std::string image_name = "image_raw";
  double rate_hz = 10.0;
  int repeat = 1;
  bool overwrite = false;
};

/// Names as people count: numbers in them by their value, so that 2 is before 10.
bool inNumberOrder(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t first = i;
    const std::size_t second = j;
    while (i < a.size() && digit(a[i])) ++i;
    while (j < b.size() && digit(b[j])) ++j;
    if (i - first != j - second) return i - first < j - second;
    const int order = a.compare(first, i - first, b, second, j - second);
    if (order != 0) return order < 0;
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

/// Files as given; a folder stands for the images in it, in the order of their numbers.
std::vector<std::string> imageFiles(const std::vector<std::string>& given) {
  std::vector<std::string> files;
  for (const std::string& path : given) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::directory_iterator(path)) {
      const bool hidden = entry.path().filename().string().front() == '.';
      if (entry.is_regular_file() && !hidden && isImageName(entry.path().string())) {
        inside.push_back(entry.path().string());
      }
    }
    if (inside.empty()) throw std::runtime_error(path + ": holds no images");
    std::sort(inside.begin(), inside.end(), inNumberOrder);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

/// Stamps of a text file: ns since the epoch, or seconds with a decimal point; what follows a comma is the name of the
/// left image, as in EuRoC's data.csv.
class StampFile {
 public:
  explicit StampFile(const std::string& path) : path_(path) {
    std::ifstream file(path);
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
      line = line.substr(0, line.find('#'));
      if (line.find_first_not_of(" \t\r") != std::string::npos) addLine(line, path + ":" + std::to_string(number));
    }
  }

  std::vector<ros::Time> stampsOf(const std::vector<std::string>& left_files, std::size_t count) const {
    if (!by_name_.empty() && by_name_.size() == stamps_.size() && count == left_files.size()) {
      std::vector<ros::Time> stamps;
      for (const std::string& file : left_files) {
        const auto found = by_name_.find(fs::path(file).filename().string());
        if (found == by_name_.end()) throw std::runtime_error(path_ + ": has no stamp for " + file);
        stamps.push_back(found->second);
      }
      return checked(stamps);
    }
    if (stamps_.size() != count) {
      throw std::runtime_error(path_ + ": " + std::to_string(stamps_.size()) + " stamps for " + std::to_string(count) +
                               " pairs");
    }
    return checked(stamps_);
  }

 private:
  void addLine(const std::string& line, const std::string& place) {
    std::istringstream in(line);
    std::string text;
    std::string name;
    std::getline(in, text, ',');
    in >> name;
    stamps_.push_back(parse(text, place));
    if (!name.empty()) by_name_[name] = stamps_.back();
  }

  static ros::Time parse(std::string text, const std::string& place) {
    text.erase(0, text.find_first_not_of(" \t\r"));
    text.erase(text.find_last_not_of(" \t\r") + 1);
    const std::size_t point = text.find('.');
    const bool digits = !text.empty() && text.find_first_not_of("0123456789.") == std::string::npos &&
                        text.find('.', std::min(point, text.size() - 1) + 1) == std::string::npos && text.size() <= 30;
    const std::string whole = text.substr(0, point);
    if (!digits || whole.size() > 19) {
      throw std::runtime_error(place + ": '" + text +
                               "' is no stamp: ns since the epoch, or seconds with a decimal point");
    }
    std::uint64_t ns = whole.empty() ? 0 : std::stoull(whole);
    if (point != std::string::npos) {
      const std::string fraction = (text.substr(point + 1) + "000000000").substr(0, 9);
      ns = whole.size() > 10 ? 0 : ns * 1000000000ULL + std::stoull(fraction);
    }
    constexpr std::uint64_t kLast = 4294967295999999999ULL;  // of ros::Time
    if (ns == 0 || ns > kLast) throw std::runtime_error(place + ": " + text + " is no time that ROS knows");
    return ros::Time().fromNSec(ns);
  }

  /// Stamps must rise, by more than whole seconds taken for ns do.
  std::vector<ros::Time> checked(const std::vector<ros::Time>& stamps) const {
    constexpr double kShortestPeriod = 1e-5;  // s
    for (std::size_t i = 1; i < stamps.size(); ++i) {
      const double period = secondsBetween(stamps[i - 1], stamps[i]);
      if (period >= kShortestPeriod) continue;
      std::ostringstream problem;
      problem << path_ << ": stamp " << i + 1 << " is " << period * 1e9
              << " ns after the one before; they must rise, in ns since the epoch or in seconds with a decimal point";
      throw std::runtime_error(problem.str());
    }
    return stamps;
  }

  std::string path_;
  std::vector<ros::Time> stamps_;
  std::map<std::string, ros::Time> by_name_;
};

/// Of the file; without one, one period after another from 1 s on.
std::vector<ros::Time> makeStamps(const Options& options, const std::vector<std::string>& left_files) {
  const std::size_t count = left_files.size() * static_cast<std::size_t>(options.repeat);
  if (!options.timestamps.empty()) return StampFile(options.timestamps).stampsOf(left_files, count);
  std::vector<ros::Time> stamps;
  for (std::size_t i = 0; i < count; ++i) stamps.emplace_back(1.0 + static_cast<double>(i) / options.rate_hz);
  return stamps;
}

/// Calibrations of another camera or resolution make a bag that no stereo node can use.
void checkCalibrations(const Options& options, const sensor_msgs::CameraInfo& left,
                       const sensor_msgs::CameraInfo& right, cv::Size size) {
  if (fs::equivalent(options.left_info, options.right_info)) {
    throw std::runtime_error(options.left_info +
                             ": given for both cameras; give the two files of one stereo calibration");
  }
  std::vector<std::string> warnings;
  stereoGeometry(left, right, size,
                 {options.left.front(), options.right.front(), options.left_info, options.right_info}, warnings);
  for (const std::string& warning : warnings) std::cerr << "images_to_bag: warning: " << warning << '\n';
}

/// One view: its topics and its calibration.
class View {
 public:
  View(const Options& options, const std::string& side, const sensor_msgs::CameraInfo& info)
      : base_(options.stereo_namespace + "/" + side + "/"), options_(options), info_(info) {}

  void write(rosbag::Bag& bag, const std::string& file, const ros::Time& stamp) {
    if (file != file_) image_ = readImage(file);
    file_ = file;
    if (image_.cols != static_cast<int>(info_.width) || image_.rows != static_cast<int>(info_.height)) {
      throw std::runtime_error(file + ": is " + std::to_string(image_.cols) + " x " + std::to_string(image_.rows) +
                               " px, its calibration is for " + std::to_string(info_.width) + " x " +
                               std::to_string(info_.height));
    }
    info_.header.stamp = stamp;
    info_.header.frame_id = options_.frame_id;
    bag.write(base_ + options_.image_name, stamp, *toImageMessage(image_, info_.header));
    bag.write(base_ + "camera_info", stamp, info_);
  }

 private:
  std::string base_;
  const Options& options_;
  sensor_msgs::CameraInfo info_;
  std::string file_;
  cv::Mat image_;
};

int writeBag(Options& options) {
  options.stereo_namespace = normalName(options.stereo_namespace);
  const auto left_files = imageFiles(options.left);
  const auto right_files = imageFiles(options.right);
  if (left_files.size() != right_files.size()) {
    throw std::runtime_error(std::to_string(left_files.size()) + " left images but " +
                             std::to_string(right_files.size()) + " right ones");
  }
  std::vector<std::string> inputs = {options.left_info, options.right_info, options.timestamps};
  inputs.insert(inputs.end(), left_files.begin(), left_files.end());
  inputs.insert(inputs.end(), right_files.begin(), right_files.end());
  checkOutputs({options.output}, inputs, options.overwrite);
  const auto stamps = makeStamps(options, left_files);
  const auto left_info = readCalibration(options.left_info);
  const auto right_info = readCalibration(options.right_info);
  checkCalibrations(options, left_info, right_info, readImage(left_files.front()).size());
  View left(options, "left", left_info);
  View right(options, "right", right_info);
  OutputBag bag(options.output);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    try {
      left.write(*bag, left_files[i % left_files.size()], stamps[i]);
      right.write(*bag, right_files[i % right_files.size()], stamps[i]);
    } catch (const rosbag::BagException& error) {
      throw std::runtime_error(options.output + ": cannot be written: " + error.what());
    }
  }
  bag.finish();
  std::cout << options.output << ": " << stamps.size() << " pairs, stamped " << stamps.front() << " to "
            << stamps.back() << " s\n";
  return 0;
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("--left", options.left, "left images, or a folder of them")->required();
  app.add_option("--right", options.right, "right images, or a folder of them")->required();
  app.add_option("--left-info", options.left_info, "calibration of the left camera (YAML of camera_calibration)")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--right-info", options.right_info, "calibration of the right camera")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--output", options.output, "bag to write")->required();
  app.add_option(
         "--timestamps", options.timestamps,
         "text file, one stamp a line: ns since the epoch, or seconds with a decimal point; or EuRoC's data.csv; "
         "replaces --rate")
      ->check(CLI::ExistingFile);
  app.add_option("--rate", options.rate_hz, "pairs per second, Hz")->check(numberIn(0.01, 1000.0));
  app.add_option("--repeat", options.repeat, "how often the images are written")->check(CLI::Range(1, 1000000));
  app.add_option("--namespace", options.stereo_namespace, "namespace of the camera (default /stereo)");
  app.add_option("--frame-id", options.frame_id, "frame of both images (default stereo_optical)");
  app.add_option("--image-name", options.image_name, "image_raw (default), or image_rect where no image_proc runs");
  addOverwriteOption(app, options.overwrite);
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  fdp_stereo::Options options;
  CLI::App app("Stereo images and calibration files to a bag (image_raw and camera_info of both views).",
               "images_to_bag");
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::writeBag(options); });
}
