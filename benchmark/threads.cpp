// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// threads LEFT RIGHT: how much faster `fast` is with more threads, on a machine with enough cores for them.
#include <sched.h>

#include <array>
#include <cstdio>

#include <opencv2/imgproc.hpp>

#include "command_line.hpp"
#include "contest.hpp"
#include "critical_path.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"

namespace fdp_stereo {
namespace {

struct Options {
  std::string left, right, preset = "fast";
  int runs = 7;
};

struct Point {
  int width, height, disparities;
};
constexpr std::array<Point, 3> kPoints = {{{640, 480, 64}, {1226, 370, 128}, {1280, 720, 128}}};

/// Medians over the runs, after one to warm up.
CriticalPath measure(const cv::Mat& left, const cv::Mat& right, const Options& options, int disparities, int threads) {
  PipelineParams params = loadPreset(options.preset);
  params.search.count = disparities;
  params.threads = threads;
  Pipeline pipeline(params);
  pipeline.run(left, right);
  std::vector<double> work, serial, path;
  for (int run = 0; run < options.runs; ++run) {
    startCriticalPath();
    pipeline.run(left, right);
    const CriticalPath of = criticalPath();
    work.push_back(of.work);
    serial.push_back(of.serial);
    path.push_back(of.path);
  }
  return {median(work), median(serial), median(path)};
}

void print(const Point& point, const cv::Mat& left, const cv::Mat& right, const Options& options) {
  std::printf("%s, %d x %d x %d\n%8s %12s %12s %18s %10s\n", options.preset.c_str(), point.width, point.height,
              point.disparities, "threads", "CPU ms", "serial ms", "critical path ms", "speed-up");
  double alone = 0.0;
  for (const int threads : {1, 2, 4, 8}) {
    const CriticalPath of = measure(left, right, options, point.disparities, threads);
    if (threads == 1) alone = of.path;
    std::printf("%8d %12.1f %12.1f %18.1f %10.2f\n", threads, of.work, of.serial, of.path, alone / of.path);
  }
}

/// Threads that run at the same time on one core, or share its units or memory, would slow each other down.
void stayOnOneCore() {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(sched_getcpu(), &one);
  sched_setaffinity(0, sizeof(one), &one);
}

int run(const Options& options) {
  stayOnOneCore();
  cv::setNumThreads(1);  // what OpenCV would share counts as serial
  const cv::Mat left = readImage(options.left), right = readImage(options.right);
  for (const Point& point : kPoints) {
    const cv::Size size(point.width, point.height);
    cv::Mat resized_left, resized_right;
    cv::resize(left, resized_left, size, 0.0, 0.0, cv::INTER_AREA);
    cv::resize(right, resized_right, size, 0.0, 0.0, cv::INTER_AREA);
    print(point, resized_left, resized_right, options);
  }
  return 0;
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("LEFT", options.left, "Left image; resized to each size")->required();
  app.add_option("RIGHT", options.right, "Right image")->required();
  app.add_option("--preset", options.preset, "Preset")->capture_default_str();
  app.add_option("--runs", options.runs, "Runs of each, after one to warm up")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("CPU time and critical path of a pair with 1, 2, 4 and 8 threads", "threads");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::run(options); });
}
