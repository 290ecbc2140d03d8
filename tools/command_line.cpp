// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <sstream>

#include "fdp_stereo/buffer.hpp"
#include "fdp_stereo/out_of_memory.hpp"

namespace fdp_stereo {
namespace {

constexpr int kBadInput = 1;
constexpr int kBadUsage = 2;

int complain(const CLI::App& app, std::string message, int code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cerr << app.get_name() << ": " << message << (code == kBadUsage ? " (see --help)" : "") << std::endl;
  return code;
}

std::string rangeText(const ParamRef& ref) {
  if (const auto* choice = std::get_if<EnumRef>(&ref.value)) {
    std::string names;
    for (const std::string& name : choice->names) names += (names.empty() ? "" : "|") + name;
    return names;
  }
  if (std::holds_alternative<bool*>(ref.value)) return "true|false";
  std::ostringstream text;
  text << ref.min << ".." << ref.max << (ref.unit.empty() ? "" : " " + ref.unit);
  return text.str();
}

}  // namespace

void addPipelineOptions(CLI::App& app, PipelineOptions& options) {
  app.add_option("--min-disparity", options.min_disparity, "Smallest disparity searched, px (search.min_disparity)");
  app.add_option("--num-disparities", options.num_disparities,
                 "Number of disparities searched, px (search.num_disparities)");
  app.add_option("--threads", options.threads, "Threads, 0 = all cores (pipeline.threads)");
  takeOneEach(*app.add_option("--set", options.assignments, "Set one parameter: stage.key=value; may be given again"),
              "KEY=VALUE");
  app.add_flag("--fill", options.fill, "Fill pixels without disparity (hole_filling.enabled=true)");
  app.add_flag_callback(
      "--list-parameters",
      [] {
        std::cout << describeParams();
        throw CLI::Success();
      },
      "Print every parameter that --set takes and exit");
}

void addMaskOptions(CLI::App& app, MaskOptions& masks) {
  app.add_option("--left-mask", masks.left,
                 "Picture of what to leave out of the rectified left image: white = left out");
  app.add_option("--right-mask", masks.right, "The same for the right image");
}

CLI::Validator numberIn(double smallest, double largest) {
  CLI::Range range(smallest, largest);
  const auto check = [range](const std::string& text) {
    const std::string problem = range(text);
    return problem.empty() && std::isnan(std::stod(text)) ? "Value " + text + " is no number" : problem;
  };
  CLI::Validator validator(range);
  return validator.operation([check](std::string& text) { return check(text); });
}

void takeOneEach(CLI::Option& option, const std::string& type_name) {
  option.type_name(type_name)->expected(1)->allow_extra_args(false)->take_all();
}

void addOverwriteOption(CLI::App& app, bool& overwrite) {
  app.add_flag("--overwrite", overwrite, "Replace outputs that exist; an input is never replaced");
}

void addSeedSimulationOptions(CLI::App& app, SeedSimulation& simulation) {
  app.add_option("--seed-share", simulation.share, "Share of the pixels whose truth becomes a seed")
      ->capture_default_str()
      ->check(numberIn(0.0, 1.0));
  app.add_option("--seed-noise", simulation.noise_px, "Standard deviation of the seeds' disparity, px")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--seed-outliers", simulation.outliers, "Share of the seeds whose disparity is drawn from the range")
      ->capture_default_str()
      ->check(numberIn(0.0, 1.0));
}

PipelineParams resolveParams(const std::string& preset, const PipelineOptions& options) {
  try {
    PipelineParams params = loadPreset(preset);
    const auto set = [&](const char* key, const std::optional<int>& value) {
      if (value) setParam(params, key, std::to_string(*value));
    };
    set("search.min_disparity", options.min_disparity);
    set("search.num_disparities", options.num_disparities);
    set("pipeline.threads", options.threads);
    for (const std::string& assignment : options.assignments) setParam(params, assignment);
    if (options.fill) params.hole_filling.enabled = true;
    validate(params);
    return params;
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

std::string describeParams() {
  PipelineParams defaults;
  std::ostringstream text;
  for (const ParamRef& ref : paramList(defaults)) {
    text << ref.key << " = " << toString(ref) << "  (" << rangeText(ref) << ")\n    " << ref.text << '\n';
  }
  return text.str();
}

std::string versionText(const std::string& tool) { return tool + " (fdp_stereo) " + FDP_STEREO_VERSION; }

int runTool(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  terminateWithMessage(app.get_name());
  keepFreedMemory();
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::setNumThreads(1);  // its pool waits for ever for a thread that could not be started, as where memory is short
  app.set_version_flag("--version", versionText(app.get_name()), "Print the version and exit");
  try {
    app.parse(argc, argv);
    return run();
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return 0;
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << '\n';
    return 0;
  } catch (const CLI::Success&) {
    return 0;
  } catch (const CLI::ParseError& error) {
    return complain(app, error.what(), kBadUsage);
  } catch (const UsageError& error) {
    return complain(app, error.what(), kBadUsage);
  } catch (...) {
    return complain(app, describeCurrentException(), kBadInput);
  }
}

}  // namespace fdp_stereo
