// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// make_seeds TRUTH --output seeds.txt: what another sensor might have seen of a scene with known disparity.
#include <cmath>
#include <fstream>
#include <string>

#include "command_line.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

struct Options {
  std::string truth;
  std::string output;
  double share = 0.005;
  double noise_px = 0.25;
  double outliers = 0.05;
  int num_disparities = 64;
  double png_scale = 256.0;
  std::uint64_t random_seed = 1;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("TRUTH", options.truth, "Disparity of the left image: .pfm or 16-bit .png")->required();
  app.add_option("-o,--output", options.output, "Text, one 'x y d' per line in px, as match --seeds reads it")->required();
  app.add_option("--share", options.share, "Share of the pixels that become seeds")->capture_default_str()->check(CLI::Range(0.0, 1.0));
  app.add_option("--noise", options.noise_px, "Standard deviation of d, px")->capture_default_str()->check(CLI::NonNegativeNumber);
  app.add_option("--outliers", options.outliers, "Share of the seeds whose d is drawn from the whole range")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--num-disparities", options.num_disparities, "The range, from 0, px")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--png-scale", options.png_scale, "Value of a .png per px")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--random-seed", options.random_seed, "The same seed gives the same file")->capture_default_str();
}

int makeSeeds(const Options& options) {
  const cv::Mat truth = readDisparity(options.truth, options.png_scale);
  cv::RNG rng(options.random_seed);
  std::ofstream file(options.output);
  file << "# x y d of " << options.truth << ", share " << options.share << ", noise " << options.noise_px << " px, outliers "
       << options.outliers << ", random seed " << options.random_seed << '\n';
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      // All drawn for every pixel, so that one option does not change what the others do.
      const bool chosen = rng.uniform(0.0, 1.0) < options.share;
      const bool wrong = rng.uniform(0.0, 1.0) < options.outliers;
      const double anything = rng.uniform(0.0, options.num_disparities - 1.0);
      const double noise = rng.gaussian(options.noise_px);
      const double d = truth.at<float>(y, x);
      if (chosen && !std::isnan(d)) file << x << ' ' << y << ' ' << (wrong ? anything : d + noise) << '\n';
    }
  }
  file.close();
  if (!file) throw std::runtime_error(options.output + ": cannot be written");
  return 0;
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Seeds from a true disparity map, with noise and outliers", "make_seeds");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::makeSeeds(options); });
}
