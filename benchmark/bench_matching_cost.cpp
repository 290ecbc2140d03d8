// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "bench_pair.hpp"

namespace fdp_stereo {
namespace {

/// bits, threads
void BM_matchingCost(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  omp_set_num_threads(static_cast<int>(state.range(1)));
  const CostScale scale =
      state.range(0) == 8 ? CostScale{CostVolume::Depth::kU8, 0.02F} : CostScale{CostVolume::Depth::kU16, 0.001F};
  MatchingCost matching_cost;
  CostVolume volume;
  for (auto _ : state) matching_cost.compute(benchmarkPair(), params.search, params.matching_cost, scale, volume);
  setBytesMoved(state, volume.bytes());  // written once; what is read stays in the cache
}
BENCHMARK(BM_matchingCost)->ArgsProduct({{8, 16}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_census(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  omp_set_num_threads(1);
  std::vector<std::uint64_t> codes;
  const cv::Mat& grey = benchmarkPair().left_grey;
  for (auto _ : state) computeCensus(grey, params.matching_cost.census, codes);
  setBytesMoved(state, grey.total() + codes.size() * sizeof(codes[0]));
}
BENCHMARK(BM_census)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fdp_stereo
