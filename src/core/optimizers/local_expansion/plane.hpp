// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace fdp_stereo::local_expansion {

/// Label of a pixel: the disparity at (x, y) is a * x + b * y + c, absolute image coordinates, px (paper eq. 2).
struct Plane {
  float a = 0.0F;
  float b = 0.0F;
  float c = 0.0F;

  float at(float x, float y) const { return a * x + b * y + c; }
  float at(int x, int y) const { return at(static_cast<float>(x), static_cast<float>(y)); }
  /// The plane with slopes (a, b) that has disparity d at (x, y).
  static Plane through(float x, float y, float d, float a, float b) { return {a, b, d - a * x - b * y}; }
};

/// One plane per pixel, each coefficient in an array of its own, row by row.
struct PlaneMap {
  std::vector<float> a, b, c;

  void resize(std::size_t size) {
    a.assign(size, 0.0F);
    b.assign(size, 0.0F);
    c.assign(size, 0.0F);
  }
  Plane get(std::size_t i) const { return {a[i], b[i], c[i]}; }
  void set(std::size_t i, const Plane& plane) {
    a[i] = plane.a;
    b[i] = plane.b;
    c[i] = plane.c;
  }
};

}  // namespace fdp_stereo::local_expansion
