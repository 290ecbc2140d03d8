// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Images and calibration files of a stereo camera to a bag with image_raw and camera_info of both views.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include <rosbag/bag.h>
#include <yaml-cpp/yaml.h>

#include "command_line.hpp"
#include "conversions.hpp"
#include "fdp_stereo/io.hpp"

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
};

/// Files as given; a folder stands for the images in it, by name.
std::vector<std::string> imageFiles(const std::vector<std::string>& given) {
  std::vector<std::string> files;
  for (const std::string& path : given) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file() && entry.path().filename().string().front() != '.') {
        inside.push_back(entry.path().string());
      }
    }
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  if (files.empty()) throw std::runtime_error("no images in " + (given.empty() ? "the arguments" : given.front()));
  return files;
}

template <typename Target>
void readMatrix(const YAML::Node& node, const std::string& name, const std::string& path, Target& target) {
  const auto values = node[name]["data"].as<std::vector<double>>();
  if (values.size() != target.size()) {
    throw std::runtime_error(path + ": " + name + " has " + std::to_string(values.size()) + " values, not " +
                             std::to_string(target.size()));
  }
  std::copy(values.begin(), values.end(), target.begin());
}

/// A file as camera_calibration writes it.
sensor_msgs::CameraInfo readCameraInfo(const std::string& path) {
  try {
    const YAML::Node node = YAML::LoadFile(path);
    sensor_msgs::CameraInfo info;
    info.width = node["image_width"].as<std::uint32_t>();
    info.height = node["image_height"].as<std::uint32_t>();
    info.distortion_model = node["distortion_model"].as<std::string>();
    info.D = node["distortion_coefficients"]["data"].as<std::vector<double>>();
    readMatrix(node, "camera_matrix", path, info.K);
    readMatrix(node, "rectification_matrix", path, info.R);
    readMatrix(node, "projection_matrix", path, info.P);
    return info;
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

/// Stamps in ns since the epoch, one a line; without a file, one period after another from 1 s on.
std::vector<ros::Time> makeStamps(const Options& options, std::size_t count) {
  std::vector<ros::Time> stamps;
  if (options.timestamps.empty()) {
    for (std::size_t i = 0; i < count; ++i) stamps.emplace_back(1.0 + static_cast<double>(i) / options.rate_hz);
    return stamps;
  }
  std::ifstream file(options.timestamps);
  std::uint64_t ns = 0;
  while (stamps.size() < count && file >> ns) stamps.push_back(ros::Time().fromNSec(ns));
  if (stamps.size() < count) {
    throw std::runtime_error(options.timestamps + ": " + std::to_string(stamps.size()) + " stamps for " +
                             std::to_string(count) + " pairs");
  }
  return stamps;
}

/// One view: its topics and its calibration.
class View {
 public:
  View(const Options& options, const std::string& side, const std::string& info_file)
      : base_(options.stereo_namespace + "/" + side + "/"), options_(options), info_(readCameraInfo(info_file)) {}

  void write(rosbag::Bag& bag, const std::string& file, const ros::Time& stamp) {
    if (file != file_) image_ = fdp_stereo::readImage(file);
    file_ = file;
    info_.header.stamp = stamp;
    info_.header.frame_id = options_.frame_id;
    bag.write(base_ + options_.image_name, stamp, *fdp_stereo::toImageMessage(image_, info_.header));
    bag.write(base_ + "camera_info", stamp, info_);
  }

 private:
  std::string base_;
  const Options& options_;
  sensor_msgs::CameraInfo info_;
  std::string file_;
  cv::Mat image_;
};

int writeBag(const Options& options) {
  const auto left_files = imageFiles(options.left);
  const auto right_files = imageFiles(options.right);
  if (left_files.size() != right_files.size()) {
    throw std::runtime_error(std::to_string(left_files.size()) + " left images but " +
                             std::to_string(right_files.size()) + " right ones");
  }
  const std::size_t count = left_files.size() * static_cast<std::size_t>(options.repeat);
  const auto stamps = makeStamps(options, count);
  View left(options, "left", options.left_info);
  View right(options, "right", options.right_info);
  rosbag::Bag bag(options.output, rosbag::bagmode::Write);
  for (std::size_t i = 0; i < count; ++i) {
    left.write(bag, left_files[i % left_files.size()], stamps[i]);
    right.write(bag, right_files[i % right_files.size()], stamps[i]);
  }
  bag.close();
  std::cout << options.output << ": " << count << " pairs\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Stereo images and calibration files to a bag (image_raw and camera_info of both views).");
  app.add_option("--left", options.left, "left images, or a folder of them")->required();
  app.add_option("--right", options.right, "right images, or a folder of them")->required();
  app.add_option("--left-info", options.left_info, "calibration of the left camera (YAML of camera_calibration)")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--right-info", options.right_info, "calibration of the right camera")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--output", options.output, "bag to write")->required();
  app.add_option("--timestamps", options.timestamps, "text file, ns since the epoch, one a line; replaces --rate")
      ->check(CLI::ExistingFile);
  app.add_option("--rate", options.rate_hz, "pairs per second, Hz")->check(CLI::Range(0.01, 1000.0));
  app.add_option("--repeat", options.repeat, "how often the images are written")->check(CLI::Range(1, 1000000));
  app.add_option("--namespace", options.stereo_namespace, "namespace of the camera (default /stereo)");
  app.add_option("--frame-id", options.frame_id, "frame of both images (default stereo_optical)");
  app.add_option("--image-name", options.image_name, "image_raw (default), or image_rect where no image_proc runs");
  return fdp_stereo::runTool(app, argc, argv, [&] { return writeBag(options); });
}
