// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arguments.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

namespace fdp_stereo {
namespace {

std::string describe(const cv::Mat& mat) {
  return std::to_string(mat.cols) + " x " + std::to_string(mat.rows) + " px, type " + cv::typeToString(mat.type());
}

void refuse(const char* stage, const cv::Mat& given, const std::string& wanted) {
  throw std::invalid_argument(std::string(stage) + ": given " + describe(given) + ", must be " + wanted);
}

std::string sizeText(cv::Size size) { return std::to_string(size.width) + " x " + std::to_string(size.height) + " px"; }

}  // namespace

void requireMap(const cv::Mat& map, const char* stage) {
  if (map.empty() || map.type() != CV_32FC1) refuse(stage, map, "a map of type CV_32FC1 that has pixels");
}

void requireMap(const cv::Mat& map, cv::Size size, const char* stage) {
  requireMap(map, stage);
  if (map.size() != size) refuse(stage, map, "of " + sizeText(size) + " as the other map");
}

void requireImage(const cv::Mat& image, cv::Size size, const char* stage) {
  if (image.size() != size || (image.type() != CV_8UC1 && image.type() != CV_8UC3)) {
    refuse(stage, image, "an image of type CV_8UC1 or CV_8UC3 and " + sizeText(size));
  }
}

Seeds finiteSeeds(const Seeds& seeds) {
  Seeds finite;
  finite.reserve(seeds.size());
  std::copy_if(seeds.begin(), seeds.end(), std::back_inserter(finite), [](const Seed& s) {
    return std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.d) && std::isfinite(s.trust);
  });
  return finite;
}

}  // namespace fdp_stereo
