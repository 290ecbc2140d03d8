// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// warp_rows IMAGE --output warped.png: what a camera that is not well rectified would have seen.
#include <string>

#include "command_line.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/row_alignment.hpp"
#include "output_files.hpp"

namespace fdp_stereo {
namespace {

struct Options {
  std::string image;
  std::string output;
  bool overwrite = false;
  double shift_px = 0.0;
  double across_px = 0.0;
  double down_px = 0.0;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("IMAGE", options.image, "8 or 16 bit, grey or colour")->required();
  app.add_option("-o,--output", options.output, "The image with its content moved up")->required();
  app.add_option("--shift", options.shift_px, "Everywhere, px")->capture_default_str();
  app.add_option("--across", options.across_px, "On top at the right border, its negative at the left one, px")
      ->capture_default_str();
  app.add_option("--down", options.down_px, "On top at the lower border, its negative at the upper one, px")
      ->capture_default_str();
  addOverwriteOption(app, options.overwrite);
}

int warpRows(const Options& options) {
  checkOutputs({options.output}, {options.image}, options.overwrite);
  const cv::Mat image = readImage(options.image);
  RowOffsetModel model;
  model.order = 1;
  model.size = image.size();
  model.coefficients.head<3>() << -options.shift_px, -options.across_px, -options.down_px;
  writeImage(options.output, alignRows(image, model));
  return 0;
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Moves the rows of an image, as a camera does that is not well rectified", "warp_rows");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::warpRows(options); });
}
