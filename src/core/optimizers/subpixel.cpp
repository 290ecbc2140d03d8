// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/subpixel.hpp"

#include <algorithm>

namespace fdp_stereo {

float subpixelOffset(SubpixelFit fit, float before, float best, float after) {
  const float rise_before = before - best;
  const float rise_after = after - best;
  const float larger = std::max(rise_before, rise_after);
  const float smaller = std::min(rise_before, rise_after);
  if (fit == SubpixelFit::kNone || larger <= 0.0F || smaller < 0.0F) return 0.0F;
  const float sign = rise_before < rise_after ? -1.0F : 1.0F;
  const float t = smaller / larger;
  switch (fit) {
    case SubpixelFit::kParabola:
      return sign * 0.5F * (larger - smaller) / (larger + smaller);
    case SubpixelFit::kEquiangular:
      return sign * 0.5F * (1.0F - t);
    default:
      return sign * (0.5F - 0.25F * (t + t * t));
  }
}

}  // namespace fdp_stereo
