// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "bench_pair.hpp"

namespace fdp_stereo {
namespace {

CostVolume benchmarkVolume(const PipelineParams& params) {
  const CostScale scale = fitCostScale(maxMatchingCost(params.matching_cost), penaltiesOf(params.semi_global));
  CostVolume volume;
  computeMatchingCost(benchmarkPair(), params.search, params.matching_cost, scale, volume);
  return volume;
}

/// penalties (above 10 the costs need 16 bits), threads
void BM_semiGlobal(benchmark::State& state) {
  PipelineParams params = benchmarkParams();
  params.semi_global.p2 = static_cast<double>(state.range(0));
  omp_set_num_threads(static_cast<int>(state.range(1)));
  const CostVolume volume = benchmarkVolume(params);
  SemiGlobalMatcher matcher;
  OptimizerOutput output;
  for (auto _ : state) matcher.match(volume, benchmarkPair().left_grey, params.semi_global, output);
  // The volume is read on the way down and up; sums of 16 bits per cell are written and read.
  const std::size_t cells = volume.bytes() / (volume.depth() == CostVolume::Depth::kU8 ? 1 : 2);
  setBytesMoved(state, 2 * volume.bytes() + 2 * cells * sizeof(std::uint16_t));
}
BENCHMARK(BM_semiGlobal)->ArgsProduct({{3, 20}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

/// threads
void BM_quasiDenseMatching(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  omp_set_num_threads(static_cast<int>(state.range(0)));
  const CostVolume volume = benchmarkVolume(params);
  SemiGlobalMatcher matcher;
  for (auto _ : state) {
    matchRoughly(volume, benchmarkPair().left_grey, params.quasi_dense, params.semi_global, matcher);
  }
  setBytesMoved(state, volume.bytes() / params.quasi_dense.row_step * 6);
}
BENCHMARK(BM_quasiDenseMatching)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// threads
void BM_quasiDensePropagation(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  omp_set_num_threads(static_cast<int>(state.range(0)));
  CostVolume volume = benchmarkVolume(params);
  SemiGlobalMatcher matcher;
  const cv::Mat& guide = benchmarkPair().left_grey;
  const RoughDisparity rough = matchRoughly(volume, guide, params.quasi_dense, params.semi_global, matcher);
  const Seeds seeds = quasiDenseSeeds(rough, guide.size(), params.quasi_dense);
  for (auto _ : state) propagateDisparity(seeds, benchmarkPair().left, surfacesOf(params.quasi_dense), volume);
  setBytesMoved(state, 2 * volume.bytes());
}
BENCHMARK(BM_quasiDensePropagation)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace fdp_stereo
