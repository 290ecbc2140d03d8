// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <omp.h>

#include "bench_pair.hpp"

namespace fdp_stereo {
namespace {

/// detector: 0 SIFT, 1 ORB, 2 FAST corners with a binary code
void BM_featureMatching(benchmark::State& state) {
  PipelineParams params = benchmarkParams();
  params.feature_matching.detector = static_cast<FeatureDetector>(state.range(0));
  const StereoPair& pair = benchmarkPair();
  for (auto _ : state) benchmark::DoNotOptimize(matchFeatures(pair, params.search, params.feature_matching));
  setBytesMoved(state, 2 * pair.left_grey.total());
}
BENCHMARK(BM_featureMatching)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

void BM_rowAlignment(benchmark::State& state) {
  const PipelineParams params = benchmarkParams();
  const StereoPair& pair = benchmarkPair();
  const FeatureMatches matches = matchFeatures(pair, params.search, params.feature_matching).matches;
  const cv::Size size = pair.left.size();
  for (auto _ : state) benchmark::DoNotOptimize(estimateRowAlignment(matches, size, params.row_alignment));
}
BENCHMARK(BM_rowAlignment)->Unit(benchmark::kMillisecond);

void BM_alignRows(benchmark::State& state) {
  omp_set_num_threads(1);
  const cv::Mat& right = benchmarkPair().right;
  RowOffsetModel model;
  model.order = 1;
  model.size = right.size();
  model.coefficients << 0.4, 0.2, -0.3, 0.0, 0.0, 0.0, 0.0;
  for (auto _ : state) benchmark::DoNotOptimize(alignRows(right, model));
  setBytesMoved(state, 2 * right.total() * right.elemSize());
}
BENCHMARK(BM_alignRows)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fdp_stereo
