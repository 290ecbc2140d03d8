// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/hidden_pixels.hpp"

#include "arguments.hpp"
#include "fdp_stereo/types.hpp"
#include "parallel.hpp"

namespace fdp_stereo {

void dropHidden(cv::Mat& disparity) {
  requireMap(disparity, "pixels seen by both views");
  const auto last = static_cast<float>(disparity.cols - 1);
  parallelFor(disparity.rows, [&](int y) {
    auto* row = disparity.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      const float match = static_cast<float>(x) - row[x];
      if (match < 0.0F || match > last) row[x] = kInvalidDisparity;
    }
  });
}

}  // namespace fdp_stereo
