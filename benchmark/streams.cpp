// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "streams.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <yaml-cpp/yaml.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

constexpr int kPanRight = 4, kPanDown = 1, kObjectStep = 9;  // px per pair

cv::Mat noisy(const cv::Mat& image, double deviation, std::uint64_t seed) {
  cv::Mat noise(image.size(), CV_MAKETYPE(CV_32F, image.channels())), sum;
  cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  cv::add(image, noise, sum, cv::noArray(), CV_32F);
  sum.convertTo(sum, image.depth());
  return sum;
}

StreamFrame frameOf(const Scene& scene) {
  StreamFrame frame{scene.left.clone(), scene.right.clone(), scene.truth.clone(), scene.truth == scene.truth, {}};
  if (!scene.mask.empty()) frame.visible &= scene.mask == 255;
  frame.object = cv::Mat::zeros(scene.left.size(), CV_8UC1);
  return frame;
}

void pan(int number, int frames, StreamFrame& frame) {
  const cv::Rect seen(kPanRight * number, kPanDown * number, frame.left.cols - kPanRight * frames,
                      frame.left.rows - kPanDown * frames);
  for (cv::Mat* map : {&frame.left, &frame.right, &frame.truth, &frame.visible, &frame.object}) {
    *map = (*map)(seen).clone();
  }
}

/// A disparity a little above all of the scene.
int objectDisparity(const Scene& scene) {
  double largest = 0.0;
  cv::minMaxLoc(scene.truth, nullptr, &largest, nullptr, nullptr, scene.truth == scene.truth);
  return std::min(scene.num_disparities - 6, static_cast<int>(largest) + 4);
}

void addObject(const cv::Mat& texture, cv::Point centre, int disparity, StreamFrame& frame) {
  const cv::Size size = frame.left.size();
  const auto ellipse = [&](cv::Point at) {
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    cv::ellipse(mask, at, {45, 70}, 0.0, 0.0, 360.0, cv::Scalar(255), cv::FILLED);
    return mask;
  };
  const auto paint = [&](cv::Point at, const cv::Mat& mask, cv::Mat& image) {
    cv::Mat shifted;
    const cv::Matx23d shift(1.0, 0.0, at.x - size.width / 2.0, 0.0, 1.0, 0.0);
    cv::warpAffine(texture, shifted, shift, size, cv::INTER_NEAREST, cv::BORDER_WRAP);
    shifted.copyTo(image, mask);
  };
  const cv::Point in_right(centre.x - disparity, centre.y);
  const cv::Mat hidden = ellipse(in_right);
  for (int y = 0; y < size.height; ++y) {  // the background that the object hides from the right view
    for (int x = 0; x < size.width; ++x) {
      const float d = frame.truth.at<float>(y, x);
      const int match = std::isfinite(d) ? x - cvRound(d) : -1;
      if (match >= 0 && hidden.at<std::uint8_t>(y, match) != 0) frame.visible.at<std::uint8_t>(y, x) = 0;
    }
  }
  frame.object = ellipse(centre);
  paint(centre, frame.object, frame.left);
  paint(in_right, hidden, frame.right);
  frame.truth.setTo(disparity, frame.object);
  frame.visible.setTo(255, frame.object);
}

/// Rectifies the images of one camera.
class Rectification {
 public:
  explicit Rectification(const std::string& path) {
    const YAML::Node file = YAML::LoadFile(path);
    const auto matrix = [&](const char* name, int rows, int cols) {
      const auto data = file[name]["data"].as<std::vector<double>>();
      return cv::Mat(data, true).reshape(1, rows).colRange(0, cols).clone();
    };
    const auto distortion = file["distortion_coefficients"]["data"].as<std::vector<double>>();
    const cv::Size size(file["image_width"].as<int>(), file["image_height"].as<int>());
    cv::initUndistortRectifyMap(matrix("camera_matrix", 3, 3), distortion, matrix("rectification_matrix", 3, 3),
                                matrix("projection_matrix", 3, 3), size, CV_32FC1, x_, y_);
  }
  cv::Mat operator()(const cv::Mat& image) const {
    cv::Mat rectified;
    cv::remap(image, rectified, x_, y_, cv::INTER_LINEAR);
    return rectified;
  }

 private:
  cv::Mat x_, y_;
};

std::vector<std::string> imagesIn(const fs::path& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".png") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

Stream makeStream(const Scene& scene, Motion motion, int frames, double noise) {
  Stream stream{scene.name, scene.num_disparities, {}};
  cv::Mat texture(scene.left.size(), scene.left.type());
  cv::RNG(5).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {}, 1.2);
  const cv::Point start(scene.left.cols / 3, scene.left.rows / 2);
  for (int i = 0; i < frames; ++i) {
    StreamFrame frame = frameOf(scene);
    if (motion == Motion::kPan) pan(i, frames, frame);
    if (motion == Motion::kObject) {
      addObject(texture, start + cv::Point(kObjectStep * i, 0), objectDisparity(scene), frame);
    }
    const auto seed = static_cast<std::uint64_t>(2 * i + 1);
    frame.left = noisy(frame.left, noise, seed);
    frame.right = noisy(frame.right, noise, seed + 1);
    stream.frames.push_back(std::move(frame));
  }
  return stream;
}

Stream readRecording(const std::string& folder, int num_disparities) {
  const fs::path root(folder);
  const Rectification left(root / "left.yaml"), right(root / "right.yaml");
  const auto lefts = imagesIn(root / "mav0/cam0/data"), rights = imagesIn(root / "mav0/cam1/data");
  if (lefts.empty() || lefts.size() != rights.size()) {
    throw std::runtime_error(folder + ": needs as many images of the left camera as of the right one");
  }
  Stream stream{root.filename().string(), num_disparities, {}};
  for (std::size_t i = 0; i < lefts.size(); ++i) {
    stream.frames.push_back({left(readImage(lefts[i])), right(readImage(rights[i])), {}, {}, {}});
  }
  return stream;
}

}  // namespace fdp_stereo
