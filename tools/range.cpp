// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// range --focal PX --baseline M: how near, how far and how exactly a stereo camera sees.
#include <iostream>

#include "command_line.hpp"
#include "search_range.hpp"

namespace fdp_stereo {
namespace {

struct Options {
  StereoGeometry geometry;
  DisparityRange range;
  int width = 0;
  double nearest_m = 0.0;
  double sigma_px = kTypicalSigmaPx;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("--focal", options.geometry.focal_px, "Focal length, px: P[0] of camera_info")
      ->required()
      ->check(numberIn(1.0, 1e5));
  app.add_option("--baseline", options.geometry.baseline_m, "Distance of the cameras, m: -P[3] / P[0] of the right one")
      ->required()
      ->check(numberIn(1e-4, 1e3));
  app.add_option("--cx-offset", options.geometry.cx_offset_px, "P[2] of the left camera less that of the right one, px")
      ->capture_default_str();
  app.add_option("--width", options.width, "Width of the image, px: nothing has a larger disparity")
      ->check(CLI::Range(1, 100000));
  app.add_option("--min-disparity", options.range.min, "px")->capture_default_str()->check(CLI::Range(-4096, 4096));
  app.add_option("--disparity-range", options.range.count, "Number of disparities")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  app.add_option("--nearest", options.nearest_m, "Print the disparity_range that sees from this distance on, m")
      ->check(numberIn(1e-3, 1e4));
  app.add_option("--sigma", options.sigma_px, "Standard deviation of the disparity, px")
      ->capture_default_str()
      ->check(numberIn(1e-3, 100.0));
}

int printRange(const Options& options) {
  constexpr int kAnyWidth = 1 << 20;
  const int width = options.width > 0 ? options.width : kAnyWidth;
  std::vector<std::string> warnings;
  checkRange(options.range, width, options.geometry, warnings);
  for (const std::string& warning : warnings) std::cout << "warning: " << warning << '\n';
  std::cout << visibleDistances(options.range, width, options.geometry) << '\n'
            << depthErrors(options.sigma_px, options.geometry) << '\n';
  if (options.nearest_m > 0.0) {
    std::cout << "to see from " << options.nearest_m << " m on: disparity_range "
              << disparityRangeFor(options.nearest_m, options.range.min, options.geometry) << '\n';
  }
  return 0;
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("How near, how far and how exactly a stereo camera sees", "range");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::printRange(options); });
}
