// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// warm_start FOLDER: what the planes of the previous frame bring to local expansion on a recording in EuRoC's layout
// (mav0/cam0, mav0/cam1, left.yaml, right.yaml).
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "command_line.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string folder;
  std::string preset = "accurate";
  int frames = 20;
  PipelineOptions pipeline;
};

/// One camera of the recording: its images in the order of time, and how they are rectified.
class Camera {
 public:
  Camera(const std::string& folder, const std::string& images, const std::string& info) {
    for (const auto& entry : fs::directory_iterator(folder + "/" + images)) files_.push_back(entry.path().string());
    std::sort(files_.begin(), files_.end());
    const YAML::Node yaml = YAML::LoadFile(folder + "/" + info);
    const cv::Size size(yaml["image_width"].as<int>(), yaml["image_height"].as<int>());
    cv::initUndistortRectifyMap(matrix(yaml["camera_matrix"]), matrix(yaml["distortion_coefficients"]),
                                matrix(yaml["rectification_matrix"]), matrix(yaml["projection_matrix"]), size, CV_32FC1,
                                map_x_, map_y_);
  }
  std::size_t count() const { return files_.size(); }
  cv::Mat image(std::size_t i) const {
    cv::Mat result;
    cv::remap(readImage(files_.at(i)), result, map_x_, map_y_, cv::INTER_LINEAR);
    return result;
  }

 private:
  static cv::Mat matrix(const YAML::Node& node) {
    const auto values = node["data"].as<std::vector<double>>();
    return cv::Mat(values, true).reshape(1, node["rows"].as<int>());
  }

  std::vector<std::string> files_;
  cv::Mat map_x_, map_y_;
};

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Energies of one frame, and the CPU time it took.
void runFrame(Pipeline& pipeline, const cv::Mat& left, const cv::Mat& right, const char* name) {
  const double start = cpuSeconds();
  const PipelineResult result = pipeline.run(left, right);
  std::printf(" | %s %5.2f s:", name, cpuSeconds() - start);
  for (const double energy : result.energies) std::printf(" %.0f", energy);
}

int compare(const Options& options) {
  PipelineParams params = resolveParams(options.preset, options.pipeline);
  const Camera left(options.folder, "mav0/cam0/data", "left.yaml");
  const Camera right(options.folder, "mav0/cam1/data", "right.yaml");
  params.local_expansion.warm_start = false;
  Pipeline cold(params);
  params.local_expansion.warm_start = true;
  Pipeline warm(params);
  const std::size_t frames = std::min({left.count(), right.count(), static_cast<std::size_t>(options.frames)});
  for (std::size_t i = 0; i < frames; ++i) {
    std::printf("frame %2zu", i);
    runFrame(cold, left.image(i), right.image(i), "cold");
    runFrame(warm, left.image(i), right.image(i), "warm");
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  fdp_stereo::Options options;
  CLI::App app("Local expansion with and without the planes of the previous frame");
  app.add_option("FOLDER", options.folder, "Recording in EuRoC's layout")->required();
  app.add_option("--preset", options.preset, "Preset by name, or a YAML file")->capture_default_str();
  app.add_option("--frames", options.frames, "Frames at most")->capture_default_str();
  fdp_stereo::addPipelineOptions(app, options.pipeline);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::compare(options); });
}
