// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <benchmark/benchmark.h>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {

/// The sample, 741 x 500 px, as the stages work on it.
inline const StereoPair& benchmarkPair() {
  static const StereoPair pair = prepareImages(readImage(FDP_STEREO_SOURCE_DIR "/sample/motorcycle/left.png"),
                                               readImage(FDP_STEREO_SOURCE_DIR "/sample/motorcycle/right.png"));
  return pair;
}

/// The fast preset with 64 disparities.
inline PipelineParams benchmarkParams() {
  PipelineParams params = loadPreset("fast");
  params.search = {0, 64};
  return params;
}

/// Bytes that one frame has to move from and to memory, as a rate beside the time.
inline void setBytesMoved(benchmark::State& state, std::size_t bytes) {
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

}  // namespace fdp_stereo
