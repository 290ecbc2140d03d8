// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/corruption.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>
#include <stdexcept>

namespace fdp_stereo {
namespace {

void addNoise(cv::Mat& image, double deviation, cv::RNG& random) {
  cv::Mat noise(image.size(), image.type());
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  image += noise;
}

/// Multiplies all channels by a map of one.
void multiply(cv::Mat& image, const cv::Mat& light) {
  cv::Mat all;
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(image.channels()), light), all);
  image = image.mul(all);
}

void noise(cv::Mat& left, cv::Mat& right, cv::RNG& random) {
  for (cv::Mat* view : {&left, &right}) addNoise(*view, 5.0, random);
}

void dark(cv::Mat& left, cv::Mat& right, cv::RNG& random) {
  for (cv::Mat* view : {&left, &right}) {
    *view *= 0.25;
    addNoise(*view, 3.0, random);
  }
}

void gain(cv::Mat& /*left*/, cv::Mat& right, cv::RNG& /*random*/) { right *= 0.6; }

void gamma(cv::Mat& /*left*/, cv::Mat& right, cv::RNG& /*random*/) {
  right /= 255.0;
  cv::pow(right, 1.5, right);
  right *= 255.0;
}

void blur(cv::Mat& /*left*/, cv::Mat& right, cv::RNG& /*random*/) { cv::GaussianBlur(right, right, cv::Size(), 1.5); }

void jpeg(cv::Mat& left, cv::Mat& right, cv::RNG& /*random*/) {
  for (cv::Mat* view : {&left, &right}) {
    cv::Mat bytes;
    view->convertTo(bytes, CV_8U);
    std::vector<std::uint8_t> file;
    cv::imencode(".jpg", bytes, file, {cv::IMWRITE_JPEG_QUALITY, 30});
    cv::imdecode(file, cv::IMREAD_UNCHANGED).convertTo(*view, CV_32F);
  }
}

void vignette(cv::Mat& left, cv::Mat& right, cv::RNG& /*random*/) {
  cv::Mat light(left.size(), CV_32FC1);
  const cv::Point2f centre(0.5F * static_cast<float>(light.cols - 1), 0.5F * static_cast<float>(light.rows - 1));
  const float corner = std::max(1.0F, centre.dot(centre));
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      const cv::Point2f off = cv::Point2f(static_cast<float>(x), static_cast<float>(y)) - centre;
      light.at<float>(y, x) = 1.0F - 0.7F * off.dot(off) / corner;
    }
  }
  for (cv::Mat* view : {&left, &right}) multiply(*view, light);
}

void saturation(cv::Mat& left, cv::Mat& right, cv::RNG& /*random*/) {
  for (cv::Mat* view : {&left, &right}) *view *= 2.0;
}

void rows(cv::Mat& /*left*/, cv::Mat& right, cv::RNG& /*random*/) {
  cv::Mat from(right.size(), CV_32FC2);
  const float width = static_cast<float>(std::max(1, from.cols - 1));
  for (int y = 0; y < from.rows; ++y) {
    for (int x = 0; x < from.cols; ++x) {
      const float down = 0.5F + static_cast<float>(x) / width;
      from.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y) - down};
    }
  }
  cv::Mat moved;
  cv::remap(right, moved, from, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  right = moved;
}

void dirt(cv::Mat& left, cv::Mat& right, cv::RNG& random) {
  for (cv::Mat* view : {&left, &right}) {
    cv::Mat light(view->size(), CV_32FC1, cv::Scalar(1.0));
    for (int spot = 0; spot < 10; ++spot) {
      const cv::Point centre(random.uniform(0, light.cols), random.uniform(0, light.rows));
      cv::circle(light, centre, cvRound(random.uniform(0.02, 0.05) * light.cols), cv::Scalar(0.3), cv::FILLED);
    }
    cv::GaussianBlur(light, light, cv::Size(), 0.01 * light.cols);
    multiply(*view, light);
  }
}

/// Largest value of as many bits, 8 at least, as the brightest pixel of both views needs.
double whiteOf(const Scene& scene) {
  double white = 255.0;
  for (const cv::Mat& view : {scene.left, scene.right}) {
    double brightest = 0.0;
    cv::minMaxLoc(view.reshape(1), nullptr, &brightest);
    while (white < brightest) white = 2.0 * white + 1.0;
  }
  return white;
}

}  // namespace

const std::vector<Corruption>& corruptions() {
  static const std::vector<Corruption> kinds = {
      {"none", "as they are", [](cv::Mat& /*left*/, cv::Mat& /*right*/, cv::RNG& /*random*/) {}},
      {"noise", "Gaussian noise of standard deviation 5 in each channel of both views", noise},
      {"dark", "both views with a quarter of the light, then noise of standard deviation 3", dark},
      {"gain", "right view with .6 of the light", gain},
      {"gamma", "right view with a gamma of 1.5", gamma},
      {"blur", "right view out of focus: blurred by a Gaussian of 1.5 px", blur},
      {"jpeg", "both views through JPEG of quality 30", jpeg},
      {"vignette", "light of both views falls with the square of the distance from the centre, to .3 in the corners",
       vignette},
      {"saturation", "both views twice as bright, cut off at white", saturation},
      {"rows", "right view lower, by .5 px at its left border to 1.5 px at its right one", rows},
      {"dirt", "10 soft spots on each lens, radius .02 to .05 of the width, that let .3 of the light through", dirt},
  };
  return kinds;
}

std::string corruptionNames() {
  std::string names;
  for (const Corruption& corruption : corruptions())
    names += (names.empty() ? "" : ", ") + std::string(corruption.name);
  return names;
}

std::vector<const Corruption*> chooseCorruptions(const std::vector<std::string>& names) {
  std::set<std::string> wanted;
  for (std::string name : names) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    wanted.insert(name);
  }
  const bool all = wanted.erase("all") > 0;
  std::vector<const Corruption*> chosen;
  for (const Corruption& corruption : corruptions()) {
    if (wanted.erase(corruption.name) > 0 || all) chosen.push_back(&corruption);
  }
  if (wanted.empty()) return chosen;
  throw std::invalid_argument("'" + *wanted.begin() + "': must be one of " + corruptionNames() + " or all");
}

void corrupt(Scene& scene, const Corruption& corruption) {
  if (corruption.name == std::string("none")) return;
  std::seed_seq name(scene.name.begin(), scene.name.end());
  std::uint32_t seed = 0;
  name.generate(&seed, &seed + 1);
  cv::RNG random(seed);
  const int depth = scene.left.depth();
  const double white = whiteOf(scene);
  cv::Mat left;
  cv::Mat right;
  scene.left.convertTo(left, CV_32F, 255.0 / white);
  scene.right.convertTo(right, CV_32F, 255.0 / white);
  corruption.apply(left, right, random);
  cv::Mat(cv::min(left, 255.0)).convertTo(scene.left, depth, white / 255.0);
  cv::Mat(cv::min(right, 255.0)).convertTo(scene.right, depth, white / 255.0);
  scene.name += std::string("+") + corruption.name;
}

std::string corruptionOf(const std::string& scene_name) {
  for (const Corruption& corruption : corruptions()) {
    const std::string end = std::string("+") + corruption.name;
    if (scene_name.size() <= end.size()) continue;
    if (scene_name.compare(scene_name.size() - end.size(), end.size(), end) == 0) return corruption.name;
  }
  return "none";
}

}  // namespace fdp_stereo
