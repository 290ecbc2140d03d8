// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "bench_pair.hpp"

namespace fdp_stereo {
namespace {

CostVolume benchmarkVolume(const PipelineParams& params, const SemiGlobal& semi_global) {
  const double steps = params.matching_cost.bits == 8 ? 252.0 : 8188.0;
  const double largest = maxMatchingCost(params.matching_cost) + semi_global.costHeadroom();
  CostVolume volume;
  computeMatchingCost(benchmarkPair(), params.search, params.matching_cost, static_cast<float>(largest / steps),
                      volume);
  return volume;
}

/// paths, bits, threads
void BM_semiGlobal(benchmark::State& state) {
  PipelineParams params = benchmarkParams();
  params.semi_global.paths = static_cast<int>(state.range(0));
  params.matching_cost.bits = static_cast<int>(state.range(1));
  omp_set_num_threads(static_cast<int>(state.range(2)));
  SemiGlobal optimizer(params.semi_global);
  const CostVolume volume = benchmarkVolume(params, optimizer);
  OptimizerOutput output;
  const Seeds seeds;
  for (auto _ : state) {
    optimizer.optimize({volume, benchmarkPair(), seeds, nullptr, &params.matching_cost, {}, {}}, output);
  }
  // The volume is read by both sweeps; sums of 16 bits per cell are written by one and read by the other.
  const std::size_t cells = volume.bytes() * 8 / static_cast<std::size_t>(params.matching_cost.bits);
  setBytesMoved(state, 2 * volume.bytes() + 2 * cells * sizeof(std::uint16_t));
}
BENCHMARK(BM_semiGlobal)->ArgsProduct({{4, 8}, {8, 16}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

/// threads
void BM_quasiDenseMatching(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  omp_set_num_threads(static_cast<int>(state.range(0)));
  SemiGlobal semi_global(params.semi_global);
  const CostVolume volume = benchmarkVolume(params, semi_global);
  for (auto _ : state) quasiDenseSeeds(volume, benchmarkPair(), params.quasi_dense, semi_global);
  setBytesMoved(state, volume.bytes() / params.quasi_dense.row_step * 6);
}
BENCHMARK(BM_quasiDenseMatching)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// threads
void BM_quasiDensePropagation(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  omp_set_num_threads(static_cast<int>(state.range(0)));
  SemiGlobal semi_global(params.semi_global);
  CostVolume volume = benchmarkVolume(params, semi_global);
  const Seeds seeds = quasiDenseSeeds(volume, benchmarkPair(), params.quasi_dense, semi_global);
  for (auto _ : state) propagateDisparity(seeds, benchmarkPair().left, surfacesOf(params.quasi_dense), volume);
  setBytesMoved(state, 2 * volume.bytes());
}
BENCHMARK(BM_quasiDensePropagation)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace fdp_stereo
