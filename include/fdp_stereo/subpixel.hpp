// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

enum class SubpixelFit { kNone, kParabola, kEquiangular, kBlended };

/// Offset in [-0.5, 0.5] of the minimum from three costs around the best integer disparity (before, best, after).
/// 0 where the three are flat. kBlended: sign * (1/2 - (t + t^2) / 4), t = smaller / larger rise.
/// Always inlined and without branches on the costs, so that loops over many pixels become vectors.
__attribute__((always_inline)) inline float subpixelOffset(SubpixelFit fit, float before, float best, float after) {
  const float rise_before = before - best;
  const float rise_after = after - best;
  const float larger = rise_before > rise_after ? rise_before : rise_after;
  const float smaller = rise_before > rise_after ? rise_after : rise_before;
  const float sign = rise_before < rise_after ? -1.0F : 1.0F;
  const bool curved = larger > 0.0F && smaller >= 0.0F;
  const float divisor = curved ? larger : 1.0F;
  const float t = smaller / divisor;
  float offset = 0.0F;
  if (fit == SubpixelFit::kParabola) offset = sign * 0.5F * (larger - smaller) / (divisor + smaller);
  if (fit == SubpixelFit::kEquiangular) offset = sign * 0.5F * (1.0F - t);
  if (fit == SubpixelFit::kBlended) offset = sign * (0.5F - 0.25F * (t + t * t));
  return curved ? offset : 0.0F;
}

}  // namespace fdp_stereo
