// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// scaling LEFT RIGHT: time and memory of the fast preset over image size and range, and the model of the time.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "command_line.hpp"
#include "contest.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

/// Memory that the preset may take: 110 MB and three bytes per cell of the volume, in the 2^20 bytes that peaks come
/// in.
constexpr double kMbPerMillionBytes = 1e6 / (1 << 20);
constexpr double kBaseMb = 110.0 * kMbPerMillionBytes;
constexpr double kMbPerMillionCells = 3.0 * kMbPerMillionBytes;

struct Point {
  int width, height, disparities;
  double pixels() const { return 1e-6 * width * height; }  // millions
  double cells() const { return pixels() * disparities; }  // millions
  double allowedMb() const { return kBaseMb + kMbPerMillionCells * cells(); }
};

constexpr std::array<Point, 10> kPoints = {{{320, 240, 32},
                                            {320, 240, 64},
                                            {480, 360, 48},
                                            {640, 480, 64},
                                            {640, 480, 96},
                                            {640, 480, 128},
                                            {800, 600, 128},
                                            {1024, 768, 128},
                                            {1280, 720, 192},
                                            {1400, 1000, 256}}};

struct Options {
  std::string left, right;
  int runs = 11;
  int threads = 2;
};

Scene sceneOf(const Point& point, const cv::Mat& left, const cv::Mat& right) {
  Scene scene;
  const cv::Size size(point.width, point.height);
  cv::resize(left, scene.left, size, 0.0, 0.0, cv::INTER_AREA);
  cv::resize(right, scene.right, size, 0.0, 0.0, cv::INTER_AREA);
  scene.num_disparities = point.disparities;
  return scene;
}

/// a + b HW + c HWD by least squares of the relative errors: the smallest image counts as much as the largest.
Eigen::Vector3d fitModel(const std::vector<double>& times) {
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(times.size()), 3);
  for (Eigen::Index i = 0; i < terms.rows(); ++i) {
    const Point& point = kPoints.at(static_cast<std::size_t>(i));
    terms.row(i) << 1.0, point.pixels(), point.cells();
    terms.row(i) /= times[static_cast<std::size_t>(i)];
  }
  return terms.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(terms.rows()));
}

double predict(const Eigen::Vector3d& model, const Point& point) {
  return model.dot(Eigen::Vector3d(1.0, point.pixels(), point.cells()));
}

void printModel(const std::vector<double>& times) {
  const Eigen::Vector3d model = fitModel(times);
  double largest = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    largest = std::max(largest, std::abs(predict(model, kPoints.at(i)) / times[i] - 1.0));
  }
  std::printf("CPU time = %.2f ms + %.2f ns x HW + %.3f ns x HWD, no point off by more than %.1f %%\n", model(0),
              model(1), model(2), 100.0 * largest);
}

/// The points take turns, so that a machine whose speed drifts does not bend the curve.
int measure(const Options& options) {
  const cv::Mat left = readImage(options.left);
  const cv::Mat right = readImage(options.right);
  std::vector<std::vector<double>> wall_ms(kPoints.size()), cpu_ms(kPoints.size());
  std::vector<double> peak_mb(kPoints.size());
  for (int run = 0; run < options.runs; ++run) {
    for (std::size_t i = 0; i < kPoints.size(); ++i) {
      const Score score = runContest({"fast"}, sceneOf(kPoints.at(i), left, right), options.threads, 1).front();
      wall_ms[i].push_back(score.median_ms);
      cpu_ms[i].push_back(score.median_cpu_ms);
      peak_mb[i] = score.peak_memory_mb;
    }
  }
  std::vector<double> medians;
  std::printf("%6s %6s %6s %10s %10s %10s %12s\n", "W", "H", "D", "ms", "CPU ms", "peak MB", "allowed MB");
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    const Point& point = kPoints.at(i);
    medians.push_back(median(cpu_ms[i]));
    std::printf("%6d %6d %6d %10.1f %10.1f %10.1f %12.1f\n", point.width, point.height, point.disparities,
                median(wall_ms[i]), medians.back(), peak_mb[i], point.allowedMb());
  }
  printModel(medians);
  return 0;
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("LEFT", options.left, "Left image; resized to each size")->required();
  app.add_option("RIGHT", options.right, "Right image")->required();
  app.add_option("--runs", options.runs, "Turns of every point")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--threads", options.threads, "Threads")->check(CLI::Range(1, 64))->capture_default_str();
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Time and memory of the fast preset over image size and range", "scaling");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::measure(options); });
}
