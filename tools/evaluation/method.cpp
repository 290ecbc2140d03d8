// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/method.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

namespace fdp_stereo {
namespace {

constexpr double kSubpixelSteps = 16.0;  // OpenCV's matchers count in 1/16 px

enum class Peer { kSgbmHh, kSgbm3Way, kBm };

int roundUpTo16(int count) { return (count + 15) / 16 * 16; }

cv::Ptr<cv::StereoMatcher> makeSgbm(int disparities, bool three_way) {
  const int block = three_way ? 5 : 3;
  const int area = block * block;
  return cv::StereoSGBM::create(0, disparities, block, 24 * area, 96 * area, 1, 63, three_way ? 10 : 0,
                                three_way ? 100 : 0, three_way ? 2 : 0,
                                three_way ? cv::StereoSGBM::MODE_SGBM_3WAY : cv::StereoSGBM::MODE_HH);
}

cv::Ptr<cv::StereoMatcher> makeBm(int disparities) {
  const cv::Ptr<cv::StereoBM> matcher = cv::StereoBM::create(disparities, 15);
  matcher->setUniquenessRatio(15);
  matcher->setSpeckleWindowSize(100);
  matcher->setSpeckleRange(4);
  return matcher;
}

/// 8-bit image with `border` columns repeated on the left, so that the matcher answers there too. StereoSGBM's
/// penalties above are those for three channels, so it is given three.
cv::Mat peerImage(const cv::Mat& image, int border, bool grey) {
  cv::Mat prepared = image;
  if (prepared.depth() == CV_16U) prepared.convertTo(prepared, CV_8U, 1.0 / 256.0);
  if (grey && prepared.channels() == 3) cv::cvtColor(prepared, prepared, cv::COLOR_BGR2GRAY);
  if (!grey && prepared.channels() == 1) cv::cvtColor(prepared, prepared, cv::COLOR_GRAY2BGR);
  cv::copyMakeBorder(prepared, prepared, 0, 0, border, 0, cv::BORDER_REPLICATE);
  return prepared;
}

PipelineResult runPeer(Peer peer, bool fill, const Scene& scene) {
  const int disparities = roundUpTo16(scene.num_disparities);
  const cv::Ptr<cv::StereoMatcher> matcher =
      peer == Peer::kBm ? makeBm(disparities) : makeSgbm(disparities, peer == Peer::kSgbm3Way);
  const cv::Mat left = peerImage(scene.left, disparities, peer == Peer::kBm);
  const cv::Mat right = peerImage(scene.right, disparities, peer == Peer::kBm);
  cv::Mat raw;
  matcher->compute(left, right, raw);
  PipelineResult result;
  raw.colRange(disparities, raw.cols).convertTo(result.disparity, CV_32F, 1.0 / kSubpixelSteps);
  result.disparity.setTo(kInvalidDisparity, result.disparity < 0.0F);
  if (fill) fillHoles(result.disparity);
  return result;
}

Method paramsMethod(const std::string& name, const PipelineParams& params, bool own_range) {
  const auto run = [params, own_range](const Scene& scene) {
    PipelineParams scene_params = params;
    if (!own_range) scene_params.search = {0, scene.num_disparities};
    return Pipeline(scene_params).run(scene.left, scene.right);
  };
  return {name, toYaml(params) + (own_range ? "" : "# the scene gives the range\n"), run};
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

}  // namespace

Method pipelineMethod(const std::string& name, const std::string& preset, const PipelineOptions& options) {
  return paramsMethod(name, resolveParams(preset, options), options.num_disparities.has_value());
}

Method variantMethod(const std::string& text, const PipelineOptions& options) {
  const std::size_t equals = text.find('=');
  const std::vector<std::string> parts = split(equals == std::string::npos ? "" : text.substr(equals + 1), ',');
  if (equals == 0 || parts.empty()) {
    throw UsageError("--variant '" + text + "': must be NAME=PRESET[,stage.key=value...]");
  }
  PipelineOptions extended = options;
  extended.assignments.insert(extended.assignments.end(), parts.begin() + 1, parts.end());
  return pipelineMethod(text.substr(0, equals), parts[0], extended);
}

std::vector<Method> peerMethods(bool fill) {
  const auto peer = [fill](const char* name, Peer which) {
    const std::string settings = std::string("OpenCV ") + CV_VERSION + " " + name + (fill ? " filled\n" : "\n");
    return Method{name, settings, [which, fill](const Scene& scene) { return runPeer(which, fill, scene); }};
  };
  return {peer("sgbm_hh", Peer::kSgbmHh), peer("sgbm_3way", Peer::kSgbm3Way), peer("bm", Peer::kBm)};
}

}  // namespace fdp_stereo
