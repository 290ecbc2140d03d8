// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Files of one stereo pair with known disparity.
struct SceneFiles {
  std::string name;
  std::string left;
  std::string right;
  std::string truth;  ///< .pfm, or .png with truth_png_scale
  double truth_png_scale = 256.0;
  std::string mask;           ///< 255 = seen by both cameras; "" = unknown
  std::string visible_truth;  ///< KITTI: truth of the pixels that both cameras see; "" elsewhere
  int num_disparities = 0;    ///< from the calibration; 0 = unknown
};

/// One stereo pair with known disparity.
struct Scene {
  std::string name;
  cv::Mat left;
  cv::Mat right;
  cv::Mat truth;            ///< CV_32FC1 px, NaN = unknown
  cv::Mat mask;             ///< CV_8UC1, 255 = seen by both cameras; empty = unknown
  int num_disparities = 0;  ///< that cover the scene: of the calibration, else the largest truth + 4
};

/// Scenes under a path: a Middlebury folder (im0.png, im1.png, calib.txt, disp0GT.pfm | disp0.pfm | disp0GT.png with
/// disp0GT.scale.txt, mask0nocc.png) is one scene; a KITTI folder (image_0 | colored_0 | image_2 beside its right
/// counterpart, disp_occ | disp_occ_0, disp_noc | disp_noc_0) is one per *_10.png; any other folder gives those of
/// its sub-folders. Sorted by name. Throws std::runtime_error where there is none.
std::vector<SceneFiles> findScenes(const std::string& path);

/// Reads the files of a scene. Throws std::runtime_error naming the file that is missing or broken, or sizes that
/// differ.
Scene readScene(const SceneFiles& files);

}  // namespace fdp_stereo
