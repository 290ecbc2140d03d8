// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// make_seeds TRUTH --output seeds.txt: what another sensor might have seen of a scene with known disparity.
#include <locale>
#include <sstream>
#include <string>

#include "command_line.hpp"
#include "evaluation/evaluation.hpp"
#include "fdp_stereo/io.hpp"
#include "output_files.hpp"

namespace fdp_stereo {
namespace {

struct Options {
  std::string truth;
  std::string output;
  int num_disparities = 64;
  double png_scale = 256.0;
  bool overwrite = false;
  SeedSimulation simulation;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("TRUTH", options.truth, "Disparity of the left image: .pfm or 16-bit .png")->required();
  app.add_option("-o,--output", options.output, "Text, one 'x y d' per line in px, as match --seeds reads it")
      ->required();
  app.add_option("--num-disparities", options.num_disparities, "The range, from 0, px")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--png-scale", options.png_scale, "Value of a .png per px")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  addSeedSimulationOptions(app, options.simulation);
  addOverwriteOption(app, options.overwrite);
  app.add_option("--random-seed", options.simulation.random_seed, "The same number gives the same file")
      ->capture_default_str();
}

int makeSeeds(const Options& options) {
  checkOutputs({options.output}, {options.truth}, options.overwrite);
  const cv::Mat truth = readDisparity(options.truth, options.png_scale);
  const SeedSimulation& simulation = options.simulation;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "# x y d of " << options.truth << ", share " << simulation.share << ", noise " << simulation.noise_px
       << " px, outliers " << simulation.outliers << ", random seed " << simulation.random_seed << '\n';
  for (const Seed& seed : simulateSeeds(truth, {0, options.num_disparities}, simulation)) {
    text << seed.x << ' ' << seed.y << ' ' << seed.d << '\n';
  }
  writeFile(options.output, text.str());
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
