// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>

#include <fdp_stereo/io.hpp>
#include <fdp_stereo/pipeline.hpp>

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: match_two_images LEFT RIGHT DISPARITY.pfm\n");
    return 2;
  }
  fdp_stereo::PipelineParams params = fdp_stereo::loadPreset("fast");
  params.search = {0, 64};  // px: the smallest disparity and how many
  fdp_stereo::Pipeline pipeline(params);
  const auto result = pipeline.run(fdp_stereo::readImage(argv[1]), fdp_stereo::readImage(argv[2]));
  fdp_stereo::writeDisparity(argv[3], result.disparity);  // CV_32FC1 px, NaN where there is none
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "match_two_images: %s\n", error.what());
  return 1;
}
