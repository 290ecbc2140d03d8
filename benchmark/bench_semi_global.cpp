// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "bench_pair.hpp"

namespace fdp_stereo {
namespace {

/// paths, bits, threads
void BM_semiGlobal(benchmark::State& state) {
  PipelineParams params = benchmarkParams();
  params.semi_global.paths = static_cast<int>(state.range(0));
  params.matching_cost.bits = static_cast<int>(state.range(1));
  omp_set_num_threads(static_cast<int>(state.range(2)));
  SemiGlobal optimizer(params.semi_global);
  const double steps = params.matching_cost.bits == 8 ? 252.0 : 8188.0;
  const auto step = static_cast<float>((maxMatchingCost(params.matching_cost) + optimizer.costHeadroom()) / steps);
  CostVolume volume;
  computeMatchingCost(benchmarkPair(), params.search, params.matching_cost, step, volume);
  OptimizerOutput output;
  const Seeds seeds;
  for (auto _ : state) {
    optimizer.optimize({volume, benchmarkPair(), seeds, nullptr, &params.matching_cost, {}}, output);
  }
  // The volume is read by both sweeps; sums of 16 bits per cell are written by one and read by the other.
  const std::size_t cells = volume.bytes() * 8 / static_cast<std::size_t>(params.matching_cost.bits);
  setBytesMoved(state, 2 * volume.bytes() + 2 * cells * sizeof(std::uint16_t));
}
BENCHMARK(BM_semiGlobal)->ArgsProduct({{4, 8}, {8, 16}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace fdp_stereo
