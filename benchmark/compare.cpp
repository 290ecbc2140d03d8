// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// compare SCENE...: time, memory and error of the presets beside OpenCV's matchers, taking turns in one process.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "contest.hpp"
#include "evaluation/evaluation.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kYardstick = "sgbm_hh";

struct Options {
  std::vector<std::string> scenes;
  std::vector<std::string> methods = contestantNames();
  std::string json;
  int runs = 7;
  int threads = 2;
  int num_disparities = 64;
};

/// One line of the table.
struct Row {
  std::string scene;
  std::string folder;  ///< that the scene belongs to
  Score score;
  DisparityErrors errors;
  bool scored = false;       ///< there is a ground truth
  double ratio = kNone;      ///< of the wall times, to SGBM_HH
  double cpu_ratio = kNone;  ///< of the CPU times
};

Scene pairWithoutTruth(const fs::path& folder, int num_disparities) {
  Scene scene;
  scene.name = folder.filename().string();
  scene.left = readImage((folder / "left.png").string());
  scene.right = readImage((folder / "right.png").string());
  scene.num_disparities = num_disparities;
  return scene;
}

/// Calls visit(folder, scene) for every scene of a path: left.png and right.png alone, or what findScenes() knows.
template <typename Visit>
void forEachScene(const std::string& path, int num_disparities, const Visit& visit) {
  const fs::path folder = fs::weakly_canonical(path);
  if (fs::exists(folder / "left.png") && fs::exists(folder / "right.png")) {
    visit(folder.parent_path().filename().string(), pairWithoutTruth(folder, num_disparities));
    return;
  }
  for (const SceneFiles& files : findScenes(folder.string())) {
    visit(fs::path(files.left).parent_path().parent_path().filename().string(), readScene(files));
  }
}

std::vector<Row> compareOn(const std::string& folder, const Scene& scene, const Options& options) {
  std::vector<Row> rows;
  double wall = kNone;
  double cpu = kNone;
  for (Score& score : runContest(options.methods, scene, options.threads, options.runs)) {
    Row row;
    row.scene = scene.name;
    row.folder = folder;
    row.scored = !scene.truth.empty();
    if (row.scored) row.errors = evaluateDisparity(score.disparity, scene.truth, scene.mask);
    if (score.method == kYardstick) {
      wall = score.median_ms;
      cpu = score.median_cpu_ms;
    }
    score.disparity.release();
    row.score = std::move(score);
    rows.push_back(std::move(row));
  }
  for (Row& row : rows) {
    row.ratio = row.score.median_ms / wall;
    row.cpu_ratio = row.score.median_cpu_ms / cpu;
  }
  return rows;
}

nlohmann::json rowJson(const Row& row) {
  const auto scored = [&](double value) { return row.scored ? value : kNone; };
  nlohmann::json stages = nlohmann::json::object();
  for (const StageTime& stage : row.score.stages) stages[stage.stage] = stage.ms;
  return {{"scene", row.scene},
          {"method", row.score.method},
          {"median_ms", row.score.median_ms},
          {"ratio_to_sgbm_hh", row.ratio},
          {"cpu_ms", row.score.median_cpu_ms},
          {"cpu_ratio_to_sgbm_hh", row.cpu_ratio},
          {"time_per_stage", stages},
          {"peak_memory", row.score.peak_memory_mb},
          {"error", scored(row.errors.bad[2])},
          {"bad_0.125", scored(row.errors.bad[0])},
          {"bad_0.25", scored(row.errors.bad[1])},
          {"bad_0.5", scored(row.errors.bad[2])},
          {"bad_1", scored(row.errors.bad[3])},
          {"bad_2", scored(row.errors.bad[4])},
          {"average_px", scored(row.errors.average_px)}};
}

/// After every scene, so that an interrupted run leaves what it has.
void writeJson(const std::string& path, const std::vector<Row>& rows) {
  nlohmann::json list = nlohmann::json::array();
  for (const Row& row : rows) list.push_back(rowJson(row));
  writeFile(path, list.dump() + "\n");
}

void printHead() {
  std::printf("%-22s %-10s %9s %9s %8s %8s %8s | %8s %8s %8s\n", "scene", "method", "ms", "CPU ms", "ratio", "CPU rat.",
              "MB", "bad .125", "bad .5", "bad 1");
}

void printRow(const Row& row) {
  std::printf("%-22s %-10s %9.1f %9.1f %8.3f %8.3f %8.1f", row.scene.c_str(), row.score.method.c_str(),
              row.score.median_ms, row.score.median_cpu_ms, row.ratio, row.cpu_ratio, row.score.peak_memory_mb);
  if (row.scored) std::printf(" | %8.2f %8.2f %8.2f", row.errors.bad[0], row.errors.bad[2], row.errors.bad[3]);
  std::printf("\n");
  std::fflush(stdout);
}

/// Medians of times and memory, weighted means of the errors of the rows of one folder and method.
Row summarise(const std::vector<Row>& rows) {
  Row summary = rows.front();
  const auto medianOf = [&](const auto& get) {
    std::vector<double> values;
    for (const Row& row : rows) values.push_back(get(row));
    return median(values);
  };
  summary.scene = rows.front().folder + ", " + std::to_string(rows.size());
  summary.score.median_ms = medianOf([](const Row& r) { return r.score.median_ms; });
  summary.score.median_cpu_ms = medianOf([](const Row& r) { return r.score.median_cpu_ms; });
  summary.score.peak_memory_mb = medianOf([](const Row& r) { return r.score.peak_memory_mb; });
  summary.ratio = medianOf([](const Row& r) { return r.ratio; });
  summary.cpu_ratio = medianOf([](const Row& r) { return r.cpu_ratio; });
  std::vector<DisparityErrors> errors;
  std::vector<double> weights;
  for (const Row& row : rows) {
    errors.push_back(row.errors);
    weights.push_back(middleburyWeight(row.scene));
  }
  summary.errors = averageErrors(errors, weights);
  return summary;
}

void printSummary(const std::vector<Row>& rows, const std::vector<std::string>& methods) {
  std::map<std::string, std::map<std::string, std::vector<Row>>> groups;
  for (const Row& row : rows) groups[row.folder][row.score.method].push_back(row);
  std::printf("\nmedians of time and memory, means of the errors (PianoL and Playtable count half):\n");
  for (const auto& [folder, by_method] : groups) {
    for (const std::string& method : methods) printRow(summarise(by_method.at(method)));
  }
}

int compare(const Options& options) {
  for (const std::string& method : options.methods) {
    const auto& known = contestantNames();
    if (std::find(known.begin(), known.end(), method) == known.end()) {
      throw UsageError("--methods " + method + ": unknown");
    }
  }
  std::vector<Row> rows;
  printHead();
  for (const std::string& path : options.scenes) {
    forEachScene(path, options.num_disparities, [&](const std::string& folder, const Scene& scene) {
      for (Row& row : compareOn(folder, scene, options)) {
        printRow(row);
        rows.push_back(std::move(row));
      }
      if (!options.json.empty()) writeJson(options.json, rows);
    });
  }
  printSummary(rows, options.methods);
  return 0;
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("SCENE", options.scenes, "Folders of scenes, as evaluate takes them, or of left.png and right.png")
      ->required();
  app.add_option("--json", options.json, "Write the rows as a list of objects");
  app.add_option("--methods", options.methods, "Methods, separated by commas")->delimiter(',')->capture_default_str();
  app.add_option("--runs", options.runs, "Timed frames per method and scene")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Threads of every method")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--num-disparities", options.num_disparities, "Range of scenes without calibration, px")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Time, memory and error of the presets beside OpenCV's matchers", "compare");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::compare(options); });
}
