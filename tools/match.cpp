// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// match LEFT RIGHT --output disparity.pfm: the disparity of one rectified pair.
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "output_files.hpp"
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
  std::string sigma;
  std::string measures;
  std::string timings;
  std::string row_alignment;
  std::string seeds;
  std::string draw_seeds;
  MaskOptions masks;
  bool log_energy = false;
  bool overwrite = false;
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
  addMaskOptions(app, options.masks);
  app.add_option("--draw-seeds", options.draw_seeds,
                 "Draw the seeds on the left image, coloured by disparity, rejected ones as crosses");
  app.add_option("--color", options.color, "Write the disparity in colours, black = none");
  app.add_option("--confidence", options.confidence, "Write the confidence 0..1: .pfm, or an 8-bit picture");
  app.add_option("--sigma", options.sigma, "Write the standard deviation of the disparity, px: .pfm, inf = none");
  app.add_option("--measures", options.measures, "Write what confidence and sigma come from: .npy of float32")
      ->group("");  // for benchmark/fit_confidence.py
  app.add_option("--row-alignment", options.row_alignment,
                 "Draw the row offset between the views and what it leaves of each match");
  app.add_option("--timings", options.timings, "Write times, memory and what the stages found as JSON");
  app.add_flag("--log-energy", options.log_energy, "Print the energy after each iteration of local_expansion");
  addOverwriteOption(app, options.overwrite);
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
  using Json = nlohmann::json;
  Json stages = Json::array();
  for (const StageTime& time : result.times) stages.push_back({{"stage", time.stage}, {"ms", time.ms}});
  const RowAlignment& rows = result.row_alignment;
  const Json json = {{"width", result.disparity.cols},
                     {"height", result.disparity.rows},
                     {"min_disparity", params.search.min},
                     {"num_disparities", params.search.count},
                     {"stages", stages},
                     {"total_ms", totalMs(result)},
                     {"peak_memory_mb", peakMemoryMb()},
                     {"valid_share", validShare(result.disparity)},
                     {"matches", result.matches.size()},
                     {"seeds", result.seeds.size()},
                     {"rejected_seeds", result.rejected_seeds.size()},
                     {"quasi_dense_seeds", result.quasi_dense_seeds.size()},
                     {"propagated_share", result.propagated_share},
                     {"feature_note", result.feature_note},
                     {"row_alignment",
                      {{"model", rows.model.name()},
                       {"matches_used", rows.matches_used},
                       {"rms_before_px", rows.rms_before_px},
                       {"rms_after_px", rows.rms_after_px},
                       {"offset_rms_px", rows.offset_rms_px},
                       {"sigma_px", rows.sigma_px},
                       {"note", rows.note},
                       {"warning", rows.warning}}},
                     {"energies", result.energies}};
  return json.dump() + "\n";
}

void writeConfidence(const std::string& path, const cv::Mat& confidence) {
  isImageName(path) ? writeImage(path, confidenceToGrey(confidence)) : writeDisparity(path, confidence);
}

/// NumPy's format, version 1.0: an array [measure][row][column].
void writeMeasures(const std::string& path, const std::vector<cv::Mat>& measures) {
  constexpr std::size_t kAlignment = 64, kPreamble = 10;
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(measures.size()) + ", " +
                       std::to_string(measures[0].rows) + ", " + std::to_string(measures[0].cols) + "), }";
  while ((kPreamble + header.size() + 1) % kAlignment != 0) header += ' ';
  header += '\n';
  std::string bytes = std::string("\x93NUMPY\x01", 7) + '\0' + static_cast<char>(header.size() % 256) +
                      static_cast<char>(header.size() / 256) + header;
  for (const cv::Mat& measure : measures) {
    bytes.append(reinterpret_cast<const char*>(measure.data), measure.total() * measure.elemSize());
  }
  writeFile(path, bytes);
}

void writeOutputs(const Options& options, const PipelineParams& params, const cv::Mat& left,
                  const PipelineResult& result) {
  writeDisparity(options.output, result.disparity);
  if (!options.color.empty()) writeImage(options.color, colorize(result.disparity, params.search));
  if (!options.confidence.empty()) writeConfidence(options.confidence, result.confidence);
  if (!options.sigma.empty()) writeDisparity(options.sigma, result.sigma);
  if (!options.measures.empty()) writeMeasures(options.measures, result.quality_measures);
  if (!options.row_alignment.empty()) {
    writeImage(options.row_alignment, drawRowAlignment(left, result.matches, result.row_alignment));
  }
  if (!options.draw_seeds.empty()) {
    writeImage(options.draw_seeds, drawSeeds(result.left, allSeeds(result), params.search));
  }
  if (!options.timings.empty()) writeFile(options.timings, timingsJson(result, params));
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
            << 100.0 * validShare(result.disparity) << " % valid, " << allSeeds(result).seeds.size() << " seeds, "
            << totalMs(result) << " ms\n";
}

/// One line on the terminal that is written over by the next.
void showProgress(int done, int all, double energy) {
  std::cerr << "\r\x1b[Koptimising: step " << done << " of " << all << ", energy " << energy << std::flush;
}

/// What would be found out after the work only.
void checkFiles(const Options& options) {
  const auto require = [](bool holds, const std::string& path, const char* names) {
    if (!path.empty() && !holds) throw std::runtime_error(path + ": must be " + names);
  };
  require(isDisparityName(options.output), options.output, ".pfm or .png");
  require(isDisparityName(options.confidence) || isImageName(options.confidence), options.confidence,
          ".pfm or a picture, as .png");
  require(isDisparityName(options.sigma), options.sigma, ".pfm");
  for (const std::string& picture : {options.color, options.row_alignment, options.draw_seeds}) {
    require(isImageName(picture), picture, ".png, .jpg, .tiff, .bmp, .webp or .ppm");
  }
  checkOutputs({options.output, options.color, options.confidence, options.sigma, options.measures,
                options.row_alignment, options.draw_seeds, options.timings},
               {options.left, options.right, options.seeds, options.masks.left, options.masks.right, options.preset},
               options.overwrite);
}

/// A range with which no pixel of the image has a match is a mistake, not an empty scene.
void checkRange(DisparityRange range, int width) {
  if (range.min < width && range.max() > -width) return;
  throw std::runtime_error("disparities " + std::to_string(range.min) + " to " + std::to_string(range.max()) +
                           " px: no pixel of an image " + std::to_string(width) +
                           " px wide can have one; set --min-disparity near 0");
}

/// Seeds of another picture, or of another size of it.
void warnOfSeedsOutside(const Seeds& seeds, cv::Size size) {
  const auto outside = std::count_if(seeds.begin(), seeds.end(), [&](const Seed& seed) {
    return !cv::Rect(cv::Point(), size).contains({cvRound(seed.x), cvRound(seed.y)});
  });
  if (outside == 0) return;
  std::cout << "warning: " << outside << " of " << seeds.size() << " seeds are outside the image, " << size.width
            << " x " << size.height << " px, and not used\n";
}

/// Exchanged views have next to no match: a second look, the other way round, tells them from a hard scene.
bool looksSwapped(const cv::Mat& left, const cv::Mat& right, const PipelineParams& params,
                  const PipelineResult& result) {
  constexpr double kFewValid = 0.25;
  constexpr std::size_t kFewMatches = 10;
  if (result.matches.size() >= kFewMatches && validShare(result.disparity) >= kFewValid) return false;
  PipelineParams quick = loadPreset("fast");
  quick.search = params.search;
  quick.threads = params.threads;
  return Pipeline(quick).run(right, left).matches.size() > 4 * std::max(kFewMatches / 2, result.matches.size());
}

int match(const Options& options) {
  const PipelineParams params = resolveParams(options.preset, options.pipeline);
  if (options.log_energy && params.optimizer != OptimizerType::kLocalExpansion) {
    throw UsageError("--log-energy needs optimizer.type=local_expansion, the others have no energy");
  }
  checkFiles(options);
  const cv::Mat left = readImage(options.left);
  const cv::Mat right = readImage(options.right);
  checkRange(params.search, left.cols);
  const Seeds seeds = options.seeds.empty() ? Seeds() : readSeeds(options.seeds, left.size());
  warnOfSeedsOutside(seeds, left.size());
  Pipeline pipeline(params);
  pipeline.setMasks(readMask(options.masks.left, left.size()), readMask(options.masks.right, left.size()));
  if (!options.measures.empty()) pipeline.setQuality(Pipeline::Quality::kWithMeasures);
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal) pipeline.setProgress(showProgress);
  const PipelineResult result = pipeline.run(left, right, seeds);
  if (terminal) std::cerr << "\r\x1b[K" << std::flush;
  writeOutputs(options, params, left, result);
  printSummary(options, params, result);
  if (looksSwapped(left, right, params, result)) {
    std::cout << "warning: hardly a match is found, but many the other way round: exchange LEFT and RIGHT\n";
  }
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
