// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation/evaluation.hpp"
#include "fdp_stereo/pipeline_params.hpp"

namespace fdp_stereo {

/// A command line that cannot be carried out (exit code 2); every other exception is bad input (exit code 1).
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Options that set the parameters of a pipeline, the same in every tool.
struct PipelineOptions {
  std::optional<int> min_disparity;
  std::optional<int> num_disparities;
  std::optional<int> threads;
  std::vector<std::string> assignments;  ///< "stage.key=value"
  bool fill = false;
};

/// Adds --min-disparity, --num-disparities, --threads, --set, --fill, and --list-parameters, which prints and exits.
void addPipelineOptions(CLI::App& app, PipelineOptions& options);

/// Files of masks, "" = none.
struct MaskOptions {
  std::string left;
  std::string right;
};

/// Adds --left-mask and --right-mask.
void addMaskOptions(CLI::App& app, MaskOptions& masks);

/// CLI::Range of numbers that "nan" is not in.
CLI::Validator numberIn(double smallest, double largest);

/// Lets a list of texts take one each time that the option is given, and nothing of what follows.
void takeOneEach(CLI::Option& option, const std::string& type_name);

/// Adds --overwrite.
void addOverwriteOption(CLI::App& app, bool& overwrite);

/// Adds --seed-share, --seed-noise and --seed-outliers.
void addSeedSimulationOptions(CLI::App& app, SeedSimulation& simulation);

/// The preset with the options over it, validated. Throws UsageError.
PipelineParams resolveParams(const std::string& preset, const PipelineOptions& options);

/// Every parameter with its default, range, unit and text, one a line.
std::string describeParams();

/// "NAME (fdp_stereo) VERSION", as --version prints it.
std::string versionText(const std::string& tool);

/// Parses the command line and runs the tool; adds --version. Returns 0; 1 and one line on stderr for bad input; 2 and
/// one line for bad usage.
int runTool(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace fdp_stereo
