// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "optimizers/local_expansion/plane.hpp"

namespace fdp_stereo::local_expansion {

/// The state of one view: a plane per pixel and what it costs there.
struct Labels {
  int width = 0;
  int height = 0;
  PlaneMap planes;
  std::vector<float> cost;  ///< data term D_p(f_p)

  void create(cv::Size size) {
    width = size.width;
    height = size.height;
    planes.resize(static_cast<std::size_t>(size.area()));
    cost.assign(static_cast<std::size_t>(size.area()), 0.0F);
  }
  bool empty() const { return width == 0; }
  cv::Size size() const { return {width, height}; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  Plane plane(int x, int y) const { return planes.get(index(x, y)); }
  float disparity(int x, int y) const { return plane(x, y).at(x, y); }
};

}  // namespace fdp_stereo::local_expansion
