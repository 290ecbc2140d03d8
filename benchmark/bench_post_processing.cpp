// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "bench_pair.hpp"

namespace fdp_stereo {
namespace {

/// Both views' disparities as semi-global matching leaves them.
const OptimizerOutput& optimized() {
  static const OptimizerOutput output = [] {
    const PipelineParams params = benchmarkParams();
    const CostScale scale = fitCostScale(maxMatchingCost(params.matching_cost), penaltiesOf(params.semi_global));
    CostVolume volume;
    computeMatchingCost(benchmarkPair(), params.search, params.matching_cost, scale, volume);
    OptimizerOutput result;
    SemiGlobalMatcher().match(volume, benchmarkPair().left_grey, params.semi_global, result);
    return result;
  }();
  return output;
}

template <typename Filter>
void run(benchmark::State& state, const Filter& filter) {
  omp_set_num_threads(1);
  for (auto _ : state) {
    state.PauseTiming();
    cv::Mat disparity = optimized().disparity_left.clone();
    state.ResumeTiming();
    filter(disparity);
  }
  setBytesMoved(state, 2 * optimized().disparity_left.total() * sizeof(float));  // read and written in place
}

void BM_leftRightCheck(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  run(state, [&](cv::Mat& d) { checkLeftRight(d, optimized().disparity_right, params.left_right_check); });
}
BENCHMARK(BM_leftRightCheck)->Unit(benchmark::kMillisecond);

void BM_speckleFilter(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  run(state, [&](cv::Mat& d) { filterSpeckles(d, params.speckle_filter); });
}
BENCHMARK(BM_speckleFilter)->Unit(benchmark::kMillisecond);

void BM_weightedMedian(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  run(state, [&](cv::Mat& d) { filterWeightedMedian(d, benchmarkPair().left, params.weighted_median); });
}
BENCHMARK(BM_weightedMedian)->Unit(benchmark::kMillisecond);

void BM_disparitySmoothing(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  run(state, [&](cv::Mat& d) { smoothDisparity(d, benchmarkPair().left, params.disparity_smoothing); });
}
BENCHMARK(BM_disparitySmoothing)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fdp_stereo
