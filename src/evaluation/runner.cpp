// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/runner.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "evaluation/pictures.hpp"
#include "evaluation/progress.hpp"
#include "evaluation/result_table.hpp"
#include "fdp_stereo/out_of_memory.hpp"
#include "process_memory.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

/// A scene to run, or the reason why there is none.
struct Task {
  SceneFiles files;
  std::string problem;
  const Corruption* corruption = nullptr;  // none
};

std::vector<Task> findTasks(const std::vector<std::string>& paths) {
  std::vector<Task> all;
  for (const std::string& path : paths) {
    try {
      for (SceneFiles& files : findScenes(path)) all.push_back({std::move(files), ""});
    } catch (const std::exception& error) {
      SceneFiles files;
      files.name = path;
      all.push_back({files, error.what()});
    }
  }
  std::set<std::string> names;
  for (Task& task : all) {
    if (!names.insert(task.files.name).second) task.problem = task.files.left + ": another scene has its name";
  }
  return all;
}

/// This shard's part of all scenes in all their kinds; what has a problem stands there once.
std::vector<Task> chooseTasks(const std::vector<Task>& scenes, const RunOptions& options) {
  std::vector<Task> all;
  for (const Task& scene : scenes) {
    if (options.corruptions.empty() || !scene.problem.empty()) all.push_back(scene);
    if (!scene.problem.empty()) continue;
    for (const Corruption* corruption : options.corruptions) all.push_back({scene.files, "", corruption});
  }
  std::vector<Task> own;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (static_cast<int>(i) % options.shard_count == options.shard_index - 1) own.push_back(all[i]);
  }
  return own;
}

double cpuMs() { return 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Share in % of the seeds on a pixel with truth that are off by more than 1 px.
double wrongSeeds(const Seeds& seeds, const cv::Mat& truth) {
  int known = 0;
  int wrong = 0;
  for (const Seed& seed : seeds) {
    const cv::Point pixel(cvRound(seed.x), cvRound(seed.y));
    if (!cv::Rect(cv::Point(), truth.size()).contains(pixel) || std::isnan(truth.at<float>(pixel))) continue;
    ++known;
    if (std::abs(seed.d - truth.at<float>(pixel)) > 1.0F) ++wrong;
  }
  return known > 0 ? 100.0 * wrong / known : kUnknown;
}

/// Fingerprint of the pixels: a scene of another data set with the same name is another scene.
std::string contentOf(const Scene& scene) {
  std::string parts;
  for (const cv::Mat& image : {scene.left, scene.right, scene.truth, scene.mask}) {
    const cv::Mat whole = image.isContinuous() ? image : image.clone();
    parts += fingerprint({reinterpret_cast<const char*>(whole.data), whole.total() * whole.elemSize()});
  }
  return fingerprint(parts + std::to_string(scene.num_disparities));
}

/// Time, CPU time and memory of one call.
class Meter {
 public:
  explicit Meter(bool alone) : alone_(alone) {
    if (alone_ && resetPeakMemory()) memory_before_ = currentMemoryMb();
    cpu_before_ = cpuMs();
    start_ = std::chrono::steady_clock::now();
  }
  void writeTo(ResultRow& row) const {
    row.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    if (!alone_) return;
    row.cpu_ms = cpuMs() - cpu_before_;
    row.memory_mb = peakMemoryMb() - memory_before_;
  }

 private:
  bool alone_;
  double memory_before_ = kUnknown;
  double cpu_before_ = 0.0;
  std::chrono::steady_clock::time_point start_;
};

class Runner {
 public:
  Runner(const std::vector<Method>& methods, const RunOptions& options, std::vector<Task> tasks)
      : methods_(methods),
        options_(options),
        tasks_(std::move(tasks)),
        outcomes_(tasks_.size()),
        progress_(static_cast<int>(tasks_.size() * methods.size())) {
    for (const Method& method : methods_) {
      settings_.push_back(fingerprint(method.settings + (options_.all_pixels ? "all pixels" : "visible pixels")));
    }
    if (!options_.folder.empty()) openTable();
  }

  RunOutcome run() {
    std::vector<std::thread> workers;
    for (int i = 1; i < options_.jobs; ++i) workers.emplace_back([this] { work(); });
    work();
    for (std::thread& worker : workers) worker.join();
    RunOutcome all;
    for (const RunOutcome& own : outcomes_) {
      all.rows.insert(all.rows.end(), own.rows.begin(), own.rows.end());
      all.failures.insert(all.failures.end(), own.failures.begin(), own.failures.end());
    }
    return all;
  }

 private:
  void openTable() {
    for (const Task& task : tasks_) {
      std::error_code none;
      const fs::path pictures = fs::path(options_.folder) / task.files.name;
      if (!fs::equivalent(pictures, fs::path(task.files.left).parent_path(), none)) continue;
      throw std::runtime_error(options_.folder + ": is the folder of the scenes; give --report another one");
    }
    fs::create_directories(options_.folder);
    const std::string name = shardTableName(options_.shard_index, options_.shard_count);
    table_ = std::make_unique<ResultTable>((fs::path(options_.folder) / name).string());
  }

  void work() {
    for (std::size_t i = next_++; i < tasks_.size(); i = next_++) {
      const Task& task = tasks_[i];
      try {
        if (!task.problem.empty()) throw std::runtime_error(task.problem);
        runScene(task, outcomes_[i]);
      } catch (...) {
        outcomes_[i].failures.push_back({task.files.name, describeCurrentException()});
        progress_.step(task.files.name + " failed", static_cast<int>(methods_.size()));
      }
    }
  }

  void runScene(const Task& task, RunOutcome& outcome) {
    Scene scene = readScene(task.files);
    if (task.corruption != nullptr) corrupt(scene, *task.corruption);
    const std::string content = contentOf(scene);
    if (!options_.folder.empty()) writeScenePictures(options_.folder, scene);
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      try {
        outcome.rows.push_back(runMethod(scene, methods_[m], settings_[m] + "-" + content));
        progress_.step(scene.name + " " + methods_[m].name);
      } catch (...) {
        outcome.failures.push_back({scene.name, methods_[m].name + ": " + describeCurrentException()});
        progress_.step(scene.name + " " + methods_[m].name + " failed");
      }
    }
  }

  ResultRow runMethod(const Scene& scene, const Method& method, const std::string& settings) {
    if (const ResultRow* earlier = table_ ? table_->find(scene.name, method.name, settings) : nullptr) return *earlier;
    ResultRow row;
    row.scene = scene.name;
    row.method = method.name;
    row.settings = settings;
    const Meter meter(options_.jobs == 1);
    const PipelineResult result = method.run(scene);
    meter.writeTo(row);
    const cv::Mat mask = options_.all_pixels ? cv::Mat() : scene.mask;
    row.errors = evaluateDisparity(result.disparity, scene.truth, mask);
    if (!result.times.empty()) addDiagnostics(result, scene, row);
    if (!options_.folder.empty()) {
      writeMethodPictures(options_.folder, scene, method.name, result);
      table_->add(row);
    }
    return row;
  }

  static void addDiagnostics(const PipelineResult& result, const Scene& scene, ResultRow& row) {
    row.seeds = static_cast<double>(result.seeds.size());
    row.seeds_wrong = wrongSeeds(result.seeds, scene.truth);
    if (!result.quasi_dense_seeds.empty()) {
      row.dense = static_cast<double>(result.quasi_dense_seeds.size());
      row.dense_wrong = wrongSeeds(result.quasi_dense_seeds, scene.truth);
    }
    if (result.row_alignment.matches_used == 0) return;
    row.rows_before_px = result.row_alignment.rms_before_px;
    row.rows_after_px = result.row_alignment.rms_after_px;
  }

  const std::vector<Method>& methods_;
  const RunOptions options_;
  const std::vector<Task> tasks_;
  std::vector<std::string> settings_;
  std::vector<RunOutcome> outcomes_;  // one per task
  Progress progress_;
  std::atomic<std::size_t> next_{0};
  std::unique_ptr<ResultTable> table_;  // none without a folder
};

}  // namespace

std::string shardTableName(int index, int count) {
  if (count == 1) return "results.csv";
  return "results-" + std::to_string(index) + "-of-" + std::to_string(count) + ".csv";
}

RunOutcome runMethods(const std::vector<std::string>& scene_paths, const std::vector<Method>& methods,
                      const RunOptions& options) {
  return Runner(methods, options, chooseTasks(findTasks(scene_paths), options)).run();
}

}  // namespace fdp_stereo
