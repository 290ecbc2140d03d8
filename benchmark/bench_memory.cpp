// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The yardstick of the other tables: how fast memory can be read and written by one core.
#include <benchmark/benchmark.h>

#include <cstring>
#include <numeric>
#include <vector>

namespace {

constexpr std::size_t kBytes = 64U << 20U;  // far beyond the caches

void BM_copy(benchmark::State& state) {
  std::vector<char> from(kBytes, 1), to(kBytes);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), kBytes);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(2 * kBytes));
}
BENCHMARK(BM_copy)->Unit(benchmark::kMillisecond);

void BM_read(benchmark::State& state) {
  const std::vector<unsigned> from(kBytes / sizeof(unsigned), 1U);
  for (auto _ : state) benchmark::DoNotOptimize(std::accumulate(from.begin(), from.end(), 0U));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(kBytes));
}
BENCHMARK(BM_read)->Unit(benchmark::kMillisecond);

}  // namespace
