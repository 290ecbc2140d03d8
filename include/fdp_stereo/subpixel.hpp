// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

enum class SubpixelFit { kNone, kParabola, kEquiangular, kBlended };

/// Offset in [-0.5, 0.5] of the minimum from three costs around the best integer disparity (before, best, after).
/// 0 where the three are flat. kBlended: sign * (1/2 - (t + t^2) / 4), t = smaller / larger rise.
float subpixelOffset(SubpixelFit fit, float before, float best, float after);

}  // namespace fdp_stereo
