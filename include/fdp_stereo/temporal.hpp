// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace fdp_stereo {

/// Stage 1: the memory of a stream, for a camera that stands still. What does not change beyond the noise is averaged
/// over the pairs before anything is matched; a pixel that changes is what the present pair shows, at once.
struct TemporalParams {
  bool enabled = true;  ///< only of pairs that are told to be a stream (Pipeline::setStream)
};

/// What the memory made of one pair.
struct TemporalReport {
  double kept_share = 0.0;  ///< of the left pixels: those that stand still
  bool repeated = false;    ///< nothing changed since the pair before, whose result this is
  std::string reset;        ///< why nothing of earlier pairs was used; empty where something was
};

}  // namespace fdp_stereo
