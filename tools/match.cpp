// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// match LEFT RIGHT --output disparity.pfm: the disparity of one rectified pair.
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iostream>

#include "command_line.hpp"
#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "json_writer.hpp"
#include "process_memory.hpp"

namespace fdp_stereo {
namespace {

struct Options {
  std::string left;
  std::string right;
  std::string output;
  std::string preset = "fast";
  std::string color;
  std::string confidence;
  std::string timings;
  std::string row_alignment;
  std::string seeds;
  std::string draw_seeds;
  bool log_energy = false;
  PipelineOptions pipeline;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("LEFT", options.left, "Left image of a rectified pair, 8 or 16 bit, grey or colour")->required();
  app.add_option("RIGHT", options.right, "Right image, of the same size")->required();
  app.add_option("-o,--output", options.output,
                 "Disparity of the left image: .pfm (float, inf = none) or .png (16 bit x 256, 0 = none)")
      ->required();
  app.add_option("--preset", options.preset, "Preset by name, or a YAML file")->capture_default_str();
  addPipelineOptions(app, options.pipeline);
  app.add_option("--seeds", options.seeds, "Seeds of another sensor: text 'x y d [trust]', 16-bit .png or .pfm");
  app.add_option("--draw-seeds", options.draw_seeds,
                 "Draw the seeds on the left image, coloured by disparity, rejected ones as crosses");
  app.add_option("--color", options.color, "Write the disparity in colours, black = none");
  app.add_option("--confidence", options.confidence, "Write the confidence 0..1: .pfm, or an 8-bit picture");
  app.add_option("--row-alignment", options.row_alignment,
                 "Draw the row offset between the views and what it leaves of each match");
  app.add_option("--timings", options.timings, "Write times, memory and what the stages found as JSON");
  app.add_flag("--log-energy", options.log_energy, "Print the energy after each iteration of local_expansion");
  std::string names;
  for (const std::string& name : presetNames()) names += " " + name;
  app.footer("Presets:" + names +
             "\nExit codes: 0 done, 1 an input or output file is at fault, 2 the command line is.");
}

double validShare(const cv::Mat& disparity) {
  return cv::countNonZero(disparity == disparity) / static_cast<double>(disparity.total());
}

double totalMs(const PipelineResult& result) {
  double total = 0.0;
  for (const StageTime& time : result.times) total += time.ms;
  return total;
}

std::string timingsJson(const PipelineResult& result, const PipelineParams& params) {
  JsonWriter json;
  json.open('{').add("width", result.disparity.cols).add("height", result.disparity.rows);
  json.add("min_disparity", params.search.min).add("num_disparities", params.search.count);
  json.open('[', "stages");
  for (const StageTime& time : result.times) json.open('{').add("stage", time.stage).add("ms", time.ms).close('}');
  json.close(']').add("total_ms", totalMs(result)).add("peak_memory_mb", peakMemoryMb());
  json.add("valid_share", validShare(result.disparity));
  json.add("matches", static_cast<double>(result.matches.size()))
      .add("seeds", static_cast<double>(result.seeds.size()));
  json.add("rejected_seeds", static_cast<double>(result.rejected_seeds.size()));
  json.add("quasi_dense_seeds", static_cast<double>(result.quasi_dense_seeds.size()));
  json.add("propagated_share", result.propagated_share).add("feature_note", result.feature_note);
  const RowAlignment& rows = result.row_alignment;
  json.open('{', "row_alignment").add("model", rows.model.name()).add("matches_used", rows.matches_used);
  json.add("rms_before_px", rows.rms_before_px).add("rms_after_px", rows.rms_after_px);
  json.add("offset_rms_px", rows.offset_rms_px).add("sigma_px", rows.sigma_px).add("note", rows.note);
  json.add("warning", rows.warning).close('}');
  json.open('[', "energies");
  for (const double energy : result.energies) json.add("", energy);
  return json.close(']').close('}').text();
}

void writeText(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

void writeConfidence(const std::string& path, const cv::Mat& confidence) {
  const bool pfm = path.size() > 4 && path.compare(path.size() - 4, 4, ".pfm") == 0;
  pfm ? writeDisparity(path, confidence) : writeImage(path, confidenceToGrey(confidence));
}

void writeOutputs(const Options& options, const PipelineParams& params, const cv::Mat& left,
                  const PipelineResult& result) {
  writeDisparity(options.output, result.disparity);
  if (!options.color.empty()) writeImage(options.color, colorize(result.disparity, params.search));
  if (!options.confidence.empty()) writeConfidence(options.confidence, result.confidence);
  if (!options.row_alignment.empty()) {
    writeImage(options.row_alignment, drawRowAlignment(left, result.matches, result.row_alignment));
  }
  if (!options.draw_seeds.empty()) {
    const cv::Mat shown = prepareImages(left, left).left;
    writeImage(options.draw_seeds, drawSeeds(shown, allSeeds(result), params.search));
  }
  if (!options.timings.empty()) writeText(options.timings, timingsJson(result, params));
}

void printSummary(const Options& options, const PipelineParams& params, const PipelineResult& result) {
  if (options.log_energy) {
    for (std::size_t i = 0; i < result.energies.size(); ++i) {
      std::cout << "iteration " << i << " energy " << std::fixed << result.energies[i] << std::defaultfloat << '\n';
    }
  }
  if (!result.feature_note.empty()) std::cout << "features: " << result.feature_note << '\n';
  const RowAlignment& rows = result.row_alignment;
  if (params.row_alignment.enabled) {
    std::cout << "row alignment: " << rows.model.name() << " from " << rows.matches_used << " matches, rows off by "
              << rows.rms_before_px << " px RMS, " << rows.rms_after_px << " px after\n";
    if (!rows.warning.empty()) std::cout << "warning: " << rows.warning << '\n';
  }
  std::cout << options.output << ": " << result.disparity.cols << " x " << result.disparity.rows << ", "
            << 100.0 * validShare(result.disparity) << " % valid, " << result.seeds.size() << " seeds, "
            << totalMs(result) << " ms\n";
}

/// One line on the terminal that is written over by the next.
void showProgress(int done, int all, double energy) {
  std::cerr << "\r\x1b[Koptimising: step " << done << " of " << all << ", energy " << energy << std::flush;
}

int match(const Options& options) {
  const PipelineParams params = resolveParams(options.preset, options.pipeline);
  if (options.log_energy && params.optimizer != OptimizerType::kLocalExpansion) {
    throw UsageError("--log-energy needs optimizer.type=local_expansion, the others have no energy");
  }
  const cv::Mat left = readImage(options.left);
  const cv::Mat right = readImage(options.right);
  const Seeds seeds = options.seeds.empty() ? Seeds() : readSeeds(options.seeds);
  Pipeline pipeline(params);
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal) pipeline.setProgress(showProgress);
  const PipelineResult result = pipeline.run(left, right, seeds);
  if (terminal) std::cerr << "\r\x1b[K" << std::flush;
  writeOutputs(options, params, left, result);
  printSummary(options, params, result);
  return 0;
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("Disparity of a rectified stereo pair", "match");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::match(options); });
}
