// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/pictures.hpp"

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "evaluation/evaluation.hpp"
#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

/// 8-bit BGR copy for display.
cv::Mat displayImage(const cv::Mat& image) {
  cv::Mat shown = toEightBit(image);
  if (shown.channels() == 3) return shown.clone();
  cv::cvtColor(shown, shown, cv::COLOR_GRAY2BGR);
  return shown;
}

/// The left image, pixels without disparity in magenta.
cv::Mat markInvalid(const cv::Mat& left, const cv::Mat& disparity) {
  cv::Mat marked = displayImage(left) / 2;
  marked.setTo(cv::Scalar(255, 0, 255), noneMask(disparity));
  return marked;
}

void write(const std::string& folder, const std::string& name, const cv::Mat& picture) {
  const fs::path path = fs::path(folder) / name;
  fs::create_directories(path.parent_path());
  writeImage(path.string(), picture);
}

}  // namespace

std::string pictureName(const std::string& scene, const std::string& method, const std::string& kind) {
  return scene + "/" + (method.empty() ? "" : method + "_") + kind + ".png";
}

void writeScenePictures(const std::string& folder, const Scene& scene) {
  write(folder, pictureName(scene.name, "", "left"), displayImage(scene.left));
  write(folder, pictureName(scene.name, "", "truth"), colorize(scene.truth, {0, scene.num_disparities}));
}

void writeMethodPictures(const std::string& folder, const Scene& scene, const std::string& method,
                         const PipelineResult& result) {
  const cv::Mat& disparity = result.disparity;
  write(folder, pictureName(scene.name, method, "disparity"), colorize(disparity, {0, scene.num_disparities}));
  write(folder, pictureName(scene.name, method, "errors"), colorizeErrors(disparity, scene.truth, scene.mask));
  write(folder, pictureName(scene.name, method, "invalid"), markInvalid(scene.left, disparity));
  const SparseDisparity seeds = allSeeds(result);
  if (!seeds.seeds.empty()) {
    const cv::Mat picture = drawSeeds(displayImage(scene.left), seeds, {0, scene.num_disparities});
    write(folder, pictureName(scene.name, method, "seeds"), picture);
  }
}

}  // namespace fdp_stereo
