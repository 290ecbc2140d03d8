// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// evaluate SCENES...: error, time and memory of presets, variants and OpenCV's matchers on scenes with known truth.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>

#include "command_line.hpp"
#include "evaluation/corruption.hpp"
#include "evaluation/method.hpp"
#include "evaluation/report.hpp"
#include "evaluation/result.hpp"
#include "evaluation/robustness.hpp"
#include "evaluation/runner.hpp"
#include "output_files.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scenes;
  std::vector<std::string> presets;
  std::vector<std::string> variants;
  std::vector<std::string> corruptions;
  bool peers = false;
  bool merge = false;
  std::string csv;
  bool overwrite = false;
  std::string shard;
  RunOptions run;
  PipelineOptions pipeline;
  std::string command;  ///< the command line, for the page
  SeedSimulation seeds = {0.0, 0.25, 0.05, 1};
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("SCENES", options.scenes, "Middlebury or KITTI folders, or folders of such");
  takeOneEach(*app.add_option("--preset", options.presets, "Presets; may be given again (default: fast)"), "NAME|FILE");
  takeOneEach(*app.add_option("--variant", options.variants, "A further set of parameters; may be given again"),
              "NAME=PRESET[,KEY=VALUE...]");
  app.add_flag("--peers", options.peers, "Run OpenCV's StereoSGBM (HH, 3WAY) and StereoBM beside them");
  addPipelineOptions(app, options.pipeline);
  addSeedSimulationOptions(app, options.seeds);
  app.add_flag("--all", options.run.all_pixels, "Score all pixels with a truth, not only those that both cameras see");
  takeOneEach(*app.add_option("--corrupt", options.corruptions,
                              "Spoil the images first: " + corruptionNames() + " or all; may be given again"),
              "KIND");
  app.add_option("--csv", options.csv, "Write the table as CSV");
  app.add_option("--report", options.run.folder,
                 "Write pictures, table and index.html here; keeps what is there and goes on where a run stopped");
  app.add_option("--jobs", options.run.jobs, "Scenes at once; above 1 times are disturbed, CPU and memory unknown")
      ->check(CLI::Range(1, 256));
  app.add_option("--shard", options.shard, "Do only the i-th of n parts of the scenes, 'i/n'; needs --report");
  addOverwriteOption(app, options.overwrite);
  app.add_flag("--merge", options.merge, "Run nothing, put the parts in --report together");
  app.footer(
      "Exit codes: 0 done, 1 a scene failed (the others are done all the same), 2 the command line is at fault.");
}

void parseShard(const std::string& text, RunOptions& run) {
  if (text.empty()) return;
  char slash = 0;
  std::istringstream in(text);
  in >> run.shard_index >> slash >> run.shard_count;
  if (!in || slash != '/' || !in.eof() || run.shard_index < 1 || run.shard_index > run.shard_count) {
    throw UsageError("--shard '" + text + "': must be i/n with 1 <= i <= n");
  }
  if (run.folder.empty()) throw UsageError("--shard needs --report, where the parts meet");
}

std::vector<const Corruption*> parseCorruptions(const std::vector<std::string>& names) {
  try {
    return chooseCorruptions(names);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("--corrupt ") + error.what());
  }
}

std::vector<Method> chooseMethods(const Options& options) {
  std::vector<Method> methods;
  std::vector<std::string> presets = options.presets;
  if (presets.empty() && options.variants.empty()) presets = {"fast"};
  for (const std::string& preset : presets) {
    methods.push_back(pipelineMethod(fs::path(preset).stem().string(), preset, options.pipeline, options.seeds));
  }
  for (const std::string& variant : options.variants) {
    methods.push_back(variantMethod(variant, options.pipeline, options.seeds));
  }
  if (options.peers) {
    const int threads = options.pipeline.threads.value_or(0);
    cv::setNumThreads(threads > 0 ? threads : cv::getNumberOfCPUs());  // once: another number ends those that work
    for (Method& peer : peerMethods(options.pipeline.fill)) methods.push_back(std::move(peer));
  }
  std::set<std::string> names;
  for (const Method& method : methods) {
    if (method.name.empty() || method.name.find_first_of("/\\\"<>&, ") != std::string::npos) {
      throw UsageError("'" + method.name + "' cannot be the name of a method: use letters, digits, '_', '-', '+', '.'");
    }
    if (!names.insert(method.name).second) throw UsageError("two methods are called '" + method.name + "'");
  }
  return methods;
}

int reportFailures(const std::vector<Failure>& failures) {
  std::set<std::string> lines;  // a scene that cannot be read fails with each corruption
  for (const Failure& failure : failures) {
    const std::string line = "evaluate: " + failure.scene + ": " + failure.problem + '\n';
    if (lines.insert(line).second) std::cerr << line;
  }
  return failures.empty() ? 0 : 1;
}

std::string joinWords(int argc, char** argv) {
  std::string text = fs::path(argv[0]).filename().string();
  for (int i = 1; i < argc; ++i) text += std::string(" ") + argv[i];
  return text;
}

std::string conditionsOf(const Options& options) {
  std::string text =
      options.run.all_pixels ? "All pixels with a truth are scored." : "Pixels that both cameras see are scored.";
  text += options.pipeline.fill ? " Holes are filled." : " Holes are not filled.";
  return text + (options.run.jobs > 1 ? " Several scenes ran at once: times are disturbed." : "");
}

/// The page shows all rows of the folder, of whichever run they are.
void writePage(const Options& options, std::size_t own_rows) {
  const std::string& folder = options.run.folder;
  const std::vector<ResultRow> rows = readCsv((fs::path(folder) / shardTableName(1, 1)).string());
  const bool others = rowsToShow(rows).size() > own_rows;
  writeReport(folder, rows,
              {conditionsOf(options) + (others ? " Rows of earlier runs are kept as they were measured." : ""),
               options.command});
}

int merge(const Options& options) {
  const std::string& folder = options.run.folder;
  if (folder.empty()) throw UsageError("--merge needs --report, the folder with the parts");
  checkOutputs({options.csv}, {}, options.overwrite);
  checkReport(folder);
  const std::vector<ResultRow> rows = mergeShards(folder);
  writeCsv((fs::path(folder) / shardTableName(1, 1)).string(), rows);
  writeReport(folder, rows, {"Put together from the tables of several runs.", options.command});
  if (!options.csv.empty()) writeCsv(options.csv, rows);
  std::cout << tableText(rows) << tableText(robustnessOf(rows));
  return 0;
}

int evaluate(Options& options) {
  if (options.merge) return merge(options);
  if (options.scenes.empty()) throw UsageError("SCENES is required");
  parseShard(options.shard, options.run);
  options.run.corruptions = parseCorruptions(options.corruptions);
  const std::vector<Method> methods = chooseMethods(options);
  checkOutputs({options.csv}, options.presets, options.overwrite);
  if (!options.run.folder.empty()) checkReport(options.run.folder);
  const RunOutcome outcome = runMethods(options.scenes, methods, options.run);
  if (!outcome.rows.empty()) std::cout << tableText(outcome.rows) << tableText(robustnessOf(outcome.rows));
  if (!options.csv.empty()) writeCsv(options.csv, outcome.rows);
  if (!options.run.folder.empty() && options.run.shard_count == 1) writePage(options, outcome.rows.size());
  return reportFailures(outcome.failures);
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Disparity errors on scenes with known truth", "evaluate");
  fdp_stereo::Options options;
  options.command = fdp_stereo::joinWords(argc, argv);
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::evaluate(options); });
}
