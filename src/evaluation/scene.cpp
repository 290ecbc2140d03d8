// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxCalibrationBytes = 65536;
constexpr int kExtraDisparities = 4;

/// The first existing one of `names` in `folder`, "" for none.
std::string firstOf(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (fs::exists(folder / name)) return (folder / name).string();
  }
  return "";
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxCalibrationBytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

/// What follows "key=" at the beginning of a line of a calibration; "" for no file or no such line.
std::string calibrationValue(const std::string& path, const std::string& key) {
  std::istringstream lines(readText(path));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    if (line.substr(0, line.find_last_not_of(" \t", equals - 1) + 1) == key) return line.substr(equals + 1);
  }
  return "";
}

/// The first digits of a text on.
std::string fromFirstDigit(const std::string& text) {
  const std::size_t digit = text.find_first_of("0123456789.");
  return digit == std::string::npos ? "" : text.substr(digit);
}

double positiveNumber(const std::string& path, const std::string& text) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0.0;
  if (in >> value && value > 0.0 && std::isfinite(value)) return value;
  throw std::runtime_error(path + ": lacks a number above 0");
}

std::string folderName(const fs::path& folder) {
  const fs::path clean = fs::absolute(folder).lexically_normal();
  return clean.has_filename() ? clean.filename().string() : clean.parent_path().filename().string();
}

SceneFiles middleburyScene(const fs::path& folder) {
  SceneFiles files;
  files.name = folderName(folder);
  files.left = (folder / "im0.png").string();
  files.right = (folder / "im1.png").string();
  files.truth = firstOf(folder, {"disp0GT.pfm", "disp0.pfm", "disp0GT.png"});
  files.mask = firstOf(folder, {"mask0nocc.png"});
  const std::string scale = firstOf(folder, {"disp0GT.scale.txt"});
  if (!scale.empty()) files.truth_png_scale = positiveNumber(scale, fromFirstDigit(readText(scale)));
  const std::string calibration = firstOf(folder, {"calib.txt"});
  const std::string count = calibrationValue(calibration, "ndisp");
  if (!count.empty()) files.num_disparities = static_cast<int>(std::min(positiveNumber(calibration, count), 1e6));
  return files;
}

/// Sorted *_10.png of a folder: the frames that KITTI gives a truth for.
std::vector<std::string> kittiFrames(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.size() > 7 && name.compare(name.size() - 7, 7, "_10.png") == 0) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<SceneFiles> kittiScenes(const fs::path& folder) {
  const std::array<std::array<const char*, 2>, 3> views = {
      {{"colored_0", "colored_1"}, {"image_2", "image_3"}, {"image_0", "image_1"}}};
  const std::string all = firstOf(folder, {"disp_occ_0", "disp_occ"});
  const std::string visible = firstOf(folder, {"disp_noc_0", "disp_noc"});
  std::vector<SceneFiles> scenes;
  for (const auto& [left, right] : views) {
    if (!scenes.empty() || !fs::is_directory(folder / left) || !fs::is_directory(folder / right)) continue;
    for (const std::string& frame : kittiFrames(folder / left)) {
      SceneFiles files;
      files.name = frame.substr(0, frame.size() - 4);
      files.left = (folder / left / frame).string();
      files.right = (folder / right / frame).string();
      files.truth = (fs::path(all.empty() ? visible : all) / frame).string();
      files.visible_truth = visible.empty() ? "" : (fs::path(visible) / frame).string();
      scenes.push_back(files);
    }
  }
  return scenes;
}

std::vector<SceneFiles> scenesOf(const fs::path& folder) {
  if (fs::exists(folder / "im0.png")) return {middleburyScene(folder)};
  return kittiScenes(folder);
}

std::vector<fs::path> subFolders(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

cv::Mat readMask(const std::string& path) {
  cv::Mat mask = readImage(path);
  if (mask.type() != CV_8UC1) throw std::runtime_error(path + ": a mask must be an 8-bit grey image");
  return mask;
}

void requireSize(const cv::Mat& image, cv::Size size, const std::string& path) {
  if (image.size() == size) return;
  throw std::runtime_error(path + ": is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                           " px, the left image " + std::to_string(size.width) + " x " + std::to_string(size.height));
}

/// 255 where both cameras see a truth, 128 where only the left does, 0 where there is none.
cv::Mat maskFromTruths(const cv::Mat& truth, const cv::Mat& visible) {
  cv::Mat mask(truth.size(), CV_8UC1, cv::Scalar(0));
  mask.setTo(128, truth == truth);
  mask.setTo(255, visible == visible);
  return mask;
}

int disparitiesFor(const cv::Mat& truth, const std::string& path) {
  double largest = 0.0;
  cv::minMaxLoc(truth, nullptr, &largest, nullptr, nullptr, truth == truth);
  if (largest > 0.0) return static_cast<int>(std::ceil(largest)) + kExtraDisparities;
  throw std::runtime_error(path + ": holds no disparity");
}

}  // namespace

std::vector<SceneFiles> findScenes(const std::string& path) {
  const fs::path folder(path);
  if (!fs::is_directory(folder)) throw std::runtime_error(path + ": no such folder");
  std::vector<SceneFiles> scenes = scenesOf(folder);
  if (scenes.empty()) {
    for (const fs::path& sub_folder : subFolders(folder)) {
      for (SceneFiles& files : scenesOf(sub_folder)) scenes.push_back(std::move(files));
    }
  }
  if (scenes.empty()) throw std::runtime_error(path + ": holds neither im0.png nor a KITTI layout");
  return scenes;
}

Scene readScene(const SceneFiles& files) {
  Scene scene;
  scene.name = files.name;
  scene.left = readImage(files.left);
  scene.right = readImage(files.right);
  requireSize(scene.right, scene.left.size(), files.right);
  if (files.truth.empty()) throw std::runtime_error(files.left + ": has no ground truth beside it");
  scene.truth = readDisparity(files.truth, files.truth_png_scale);
  scene.truth.setTo(kInvalidDisparity, scene.truth <= 0.0F);
  requireSize(scene.truth, scene.left.size(), files.truth);
  if (!files.visible_truth.empty()) {
    const cv::Mat visible = readDisparity(files.visible_truth);
    requireSize(visible, scene.left.size(), files.visible_truth);
    scene.mask = maskFromTruths(scene.truth, visible);
  } else if (!files.mask.empty()) {
    scene.mask = readMask(files.mask);
    requireSize(scene.mask, scene.left.size(), files.mask);
  }
  scene.num_disparities = files.num_disparities > 0 ? files.num_disparities : disparitiesFor(scene.truth, files.truth);
  return scene;
}

}  // namespace fdp_stereo
