// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_file.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& problem) {
  throw std::runtime_error(path + ": " + problem +
                           "; wanted is the YAML of camera_calibration, with image_width, image_height, camera_matrix, "
                           "distortion_model, distortion_coefficients, rectification_matrix and projection_matrix");
}

/// Files that are often taken for the YAML of camera_calibration.
void refuseOtherKinds(const std::string& path) {
  constexpr std::size_t kEnough = 4096;
  std::string text(kEnough, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const auto has = [&](const char* part) { return text.find(part) != std::string::npos; };
  if (has("%YAML:") || has("!!opencv-matrix") || has("<opencv_storage"))
    refuse(path, "is a file of OpenCV's FileStorage");
  if (has("oST version") || has("[image]")) refuse(path, "is an .ini file");
}

YAML::Node required(const YAML::Node& node, const char* key, const std::string& path) {
  const YAML::Node value = node[key];
  if (!value) refuse(path, std::string("lacks ") + key);
  return value;
}

std::uint32_t readSide(const YAML::Node& node, const char* key, const std::string& path) {
  const YAML::Node value = required(node, key, path);
  const int side = value.IsScalar() ? value.as<int>(0) : 0;
  if (side >= 1 && side <= kMaxImageSide) return static_cast<std::uint32_t>(side);
  const std::string given = value.IsScalar() ? value.Scalar() : "no number";
  throw std::runtime_error(path + ": " + key + " is " + given + ", must be a whole number from 1 to " +
                           std::to_string(kMaxImageSide));
}

std::vector<double> readValues(const YAML::Node& node, const char* key, const std::string& path) {
  const YAML::Node matrix = required(node, key, path);
  if (!matrix.IsMap() || !matrix["data"]) refuse(path, std::string(key) + " has no data");
  return matrix["data"].as<std::vector<double>>();
}

template <typename Target>
void readMatrix(const YAML::Node& node, const char* key, const std::string& path, Target& target) {
  const std::vector<double> values = readValues(node, key, path);
  if (values.size() != target.size()) {
    throw std::runtime_error(path + ": " + key + " has " + std::to_string(values.size()) + " values, not " +
                             std::to_string(target.size()));
  }
  std::copy(values.begin(), values.end(), target.begin());
}

}  // namespace

sensor_msgs::CameraInfo readCalibration(const std::string& path) {
  refuseOtherKinds(path);
  try {
    const YAML::Node node = YAML::LoadFile(path);
    if (!node.IsMap()) refuse(path, "holds no keys");
    sensor_msgs::CameraInfo info;
    info.width = readSide(node, "image_width", path);
    info.height = readSide(node, "image_height", path);
    info.distortion_model = required(node, "distortion_model", path).as<std::string>();
    info.D = readValues(node, "distortion_coefficients", path);
    readMatrix(node, "camera_matrix", path, info.K);
    readMatrix(node, "rectification_matrix", path, info.R);
    readMatrix(node, "projection_matrix", path, info.P);
    return info;
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace fdp_stereo
