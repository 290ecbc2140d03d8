// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace fdp_stereo {

/// The rows of an image that take part: every step-th one.
struct RowGrid {
  int step = 1;
  int first = 0;
  int count = 0;

  RowGrid(int height, int row_step) : step(row_step), first(std::min(row_step / 2, height - 1)) {
    count = (height - 1 - first) / step + 1;
  }
  int imageRow(int row) const { return first + row * step; }
  bool takes(int image_row) const { return image_row >= first && (image_row - first) % step == 0; }
  int rowOf(int image_row) const { return (image_row - first) / step; }
};

}  // namespace fdp_stereo
