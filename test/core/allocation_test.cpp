// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// After the first frame of a size the volume, propagation and optimiser stages take no memory from the heap.
#include <atomic>
#include <cerrno>
#include <cstdlib>

#include <gtest/gtest.h>
#include <omp.h>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/pipeline_params.hpp"
#include "reference/random_images.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FDP_STEREO_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FDP_STEREO_SANITIZED
#endif
#endif
#if defined(__GLIBC__) && !defined(FDP_STEREO_SANITIZED)
#define FDP_STEREO_COUNTS_ALLOCATIONS
#endif

namespace {
std::atomic<long> allocations{0};
}  // namespace

#ifdef FDP_STEREO_COUNTS_ALLOCATIONS
// In place of glibc's own for the whole process: operator new, OpenCV and OpenMP end up here too.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}
#endif

namespace fdp_stereo {
namespace {

/// The three stages with what they keep from frame to frame.
struct Stages {
  PipelineParams params;
  SemiGlobal optimizer;
  MatchingCost matching_cost;
  CostVolume volume;
  OptimizerOutput output;
  float step;

  explicit Stages(const PipelineParams& p) : params(p), optimizer(p.semi_global) {
    const double headroom = optimizer.costHeadroom();
    step = static_cast<float>((maxMatchingCost(p.matching_cost) + headroom) /
                              (p.matching_cost.bits == 8 ? 252.0 : 8188.0));
  }

  void run(const StereoPair& pair, const Seeds& seeds) {
    matching_cost.compute(pair, params.search, params.matching_cost, step, volume);
    propagateDisparity(seeds, pair.left, params.disparity_propagation, volume);
    optimizer.optimize({volume, pair, seeds, nullptr, &params.matching_cost, {}, {}}, output);
  }
};

Seeds seedsOf(int cols, int rows, SeedSource source) {
  Seeds seeds;
  for (int i = 0; i < 300; ++i) {
    seeds.push_back({static_cast<float>(i * 37 % cols), static_cast<float>(i * 53 % rows),
                     6.0F + 0.01F * static_cast<float>(i), 0.9F, source});
  }
  return seeds;
}

class AllocationOfStages : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Bits, AllocationOfStages, testing::Values(8, 16));

TEST(Allocation, IsCounted) {
#ifndef FDP_STEREO_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "a sanitizer, or a C library other than glibc, owns malloc";
#endif
  const long before = allocations;
  std::vector<int> memory(1000, 1);
  cv::Mat image(100, 100, CV_8UC1);
  EXPECT_GE(allocations - before, 2) << memory.back() + image.rows;
}

TEST_P(AllocationOfStages, SteadyStateOfTheFastPresetTakesNone) {
#ifndef FDP_STEREO_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "a sanitizer, or a C library other than glibc, owns malloc";
#endif
  PipelineParams params = loadPreset("fast");
  params.search = {0, 40};
  params.matching_cost.bits = GetParam();
  params.disparity_propagation.enabled = true;
  params.disparity_propagation.form = PropagationForm::kWindow;
  const reference::RenderedPair first = reference::renderPair(120, 200, 6, 15, 5);
  const reference::RenderedPair second = reference::renderPair(120, 200, 8, 20, 9);
  const StereoPair pairs[2] = {prepareImages(first.left, first.right), prepareImages(second.left, second.right)};
  const Seeds seeds = seedsOf(200, 120, SeedSource::kPoints);
  omp_set_num_threads(2);
  Stages stages(params);
  for (int frame = 0; frame < 5; ++frame) {
    const long before = allocations;
    stages.run(pairs[frame % 2], seeds);
    if (frame < 2) continue;
    EXPECT_EQ(allocations - before, 0) << "frame " << frame;
  }
}

}  // namespace
}  // namespace fdp_stereo
