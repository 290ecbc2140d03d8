// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "contest.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <stdexcept>

#include "evaluation/peer.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "process_memory.hpp"

namespace fdp_stereo {
namespace {

using Clock = std::chrono::steady_clock;

double elapsedMs(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

double cpuMs() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Times of one contestant, run by run.
struct Record {
  std::vector<double> wall_ms, cpu_ms;
  std::vector<std::vector<StageTime>> stages;
};

void runOnce(const Contestant& contestant, Record& record) {
  const double cpu = cpuMs();
  const auto start = Clock::now();
  record.stages.push_back(contestant.run());
  record.wall_ms.push_back(elapsedMs(start));
  record.cpu_ms.push_back(cpuMs() - cpu);
}

std::vector<StageTime> medianStages(const Record& record) {
  std::vector<StageTime> stages = record.stages.front();
  for (std::size_t i = 0; i < stages.size(); ++i) {
    std::vector<double> times;
    for (const auto& run : record.stages) times.push_back(run[i].ms);
    stages[i].ms = median(times);
  }
  return stages;
}

Contestant makePeer(Peer peer, const Scene& scene) {
  const auto matcher = std::make_shared<PeerMatcher>(peer, scene);
  const auto run = [matcher]() -> std::vector<StageTime> {
    const auto start = Clock::now();
    matcher->compute();
    return {{"compute", elapsedMs(start)}};
  };
  const auto disparity = [matcher] {
    cv::Mat filled = matcher->disparity();
    fillHoles(filled);
    return filled;
  };
  return {peerName(peer), run, disparity};
}

Contestant makePreset(const std::string& name, const Scene& scene, int threads) {
  PipelineParams params = loadPreset(name);
  params.search = {0, scene.num_disparities};
  params.threads = threads;
  params.hole_filling.enabled = true;
  const auto pipeline = std::make_shared<Pipeline>(params);
  const auto last = std::make_shared<PipelineResult>();
  const auto run = [pipeline, last, left = scene.left, right = scene.right] {
    *last = pipeline->run(left, right);
    return last->times;
  };
  return {name, run, [last] { return last->disparity; }};
}

}  // namespace

const std::vector<std::string>& contestantNames() {
  static const std::vector<std::string> names = {"fast", "light", "accurate", "paper", "sgbm_hh", "sgbm_3way", "bm"};
  return names;
}

Contestant makeContestant(const std::string& name, const Scene& scene, int threads) {
  for (const Peer peer : {Peer::kSgbmHh, Peer::kSgbm3Way, Peer::kBm}) {
    if (name == peerName(peer)) return makePeer(peer, scene);
  }
  return makePreset(name, scene, threads);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? 0.0 : 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

std::vector<Score> runContest(const std::vector<std::string>& names, const Scene& scene, int threads, int runs) {
  cv::setNumThreads(threads);
  resetPeakMemory();
  const double alone_mb = currentMemoryMb();
  std::vector<Contestant> contestants;
  std::vector<Score> scores(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    resetPeakMemory();
    const double before_mb = currentMemoryMb();
    contestants.push_back(makeContestant(names[i], scene, threads));
    contestants.back().run();
    scores[i].method = names[i];
    scores[i].peak_memory_mb = peakMemoryMb() - before_mb + alone_mb;
  }
  std::vector<Record> records(names.size());
  for (int run = 0; run < runs; ++run) {
    for (std::size_t i = 0; i < names.size(); ++i) runOnce(contestants[i], records[i]);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    scores[i].median_ms = median(records[i].wall_ms);
    scores[i].median_cpu_ms = median(records[i].cpu_ms);
    scores[i].stages = medianStages(records[i]);
    scores[i].disparity = contestants[i].disparity();
  }
  return scores;
}

}  // namespace fdp_stereo
