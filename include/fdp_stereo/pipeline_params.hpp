// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "fdp_stereo/disparity_propagation.hpp"
#include "fdp_stereo/disparity_smoothing.hpp"
#include "fdp_stereo/feature_matching.hpp"
#include "fdp_stereo/hole_closing.hpp"
#include "fdp_stereo/hole_filling.hpp"
#include "fdp_stereo/left_right_check.hpp"
#include "fdp_stereo/local_expansion.hpp"
#include "fdp_stereo/matching_cost.hpp"
#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/quasi_dense.hpp"
#include "fdp_stereo/row_alignment.hpp"
#include "fdp_stereo/semi_global.hpp"
#include "fdp_stereo/sparse_disparity.hpp"
#include "fdp_stereo/speckle_filter.hpp"
#include "fdp_stereo/temporal.hpp"
#include "fdp_stereo/weighted_median.hpp"
#include "fdp_stereo/winner_takes_all.hpp"

namespace fdp_stereo {

/// As it stands, this is the preset "fast".
struct PipelineParams {
  DisparityRange search;
  int threads = 0;              ///< 0 = all cores
  double scale = 1.0;           ///< of the sides of the images that are matched; the disparity has full size again
  double max_memory_mb = 4096;  ///< a pair that would need more is refused
  TemporalParams temporal;
  FeatureMatchingParams feature_matching;
  RowAlignmentParams row_alignment;
  MatchingCostParams matching_cost;
  SparseDisparityParams sparse_disparity;
  DisparityPropagationParams disparity_propagation;
  QuasiDenseParams quasi_dense;
  OptimizerType optimizer = OptimizerType::kSemiGlobal;
  WinnerTakesAllParams winner_takes_all;
  SemiGlobalParams semi_global;
  LocalExpansionParams local_expansion;
  LeftRightCheckParams left_right_check;
  SpeckleFilterParams speckle_filter;
  HoleClosingParams hole_closing;
  HoleFillingParams hole_filling;
  WeightedMedianParams weighted_median;
  DisparitySmoothingParams disparity_smoothing;
};

/// A named choice, set and read by the name of its value.
struct EnumRef {
  std::vector<std::string> names;
  std::function<int()> get;
  std::function<void(int)> set;
};

/// When a person who tunes by hand meets a parameter: rqt shows the steps in this order, the experts' ones closed.
enum class TuningStep { kSearch, kSmoothness, kFilters, kSeeds, kNode, kExpert };

/// One parameter: where it lives, what it may be, what it does. The one list that YAML, ROS, --help and the
/// docs are made from.
struct ParamRef {
  std::string key;  ///< "stage.name"
  std::variant<bool*, int*, double*, EnumRef> value;
  double min = 0.0;  ///< of numbers, inclusive
  double max = 0.0;
  std::string unit;      ///< "" where there is none
  std::string text;      ///< one sentence: the effect
  std::string ros_name;  ///< name in ROS; the key's place may be taken by it everywhere
  TuningStep step = TuningStep::kExpert;
};

/// Every parameter of `params`, in the order of the pipeline. The references live as long as `params`.
std::vector<ParamRef> paramList(PipelineParams& params);

/// The parameter with this key or ROS name; nullptr where there is none.
const ParamRef* findParam(const std::vector<ParamRef>& refs, const std::string& name);
/// What to write in place of a name that is in no list: the nearest one, or the successor of one of stereo_image_proc.
std::string adviceFor(const std::vector<ParamRef>& refs, const std::string& unknown);

/// False for real numbers alone.
bool isWhole(const ParamRef& ref);
/// The value as a number: true is 1, a choice is the index of its name.
double toNumber(const ParamRef& ref);
/// The reverse; the number must be allowed.
void setFromNumber(const ParamRef& ref, double number);
/// The value as text: "true", "12", "0.5", "rho_census".
std::string toString(const ParamRef& ref);
/// Sets one value; a choice by its name or index. Throws std::invalid_argument naming key, value and what is allowed.
void setFromString(const ParamRef& ref, const std::string& text);
/// Sets by key or ROS name; an unknown one throws std::invalid_argument with the nearest.
void setParam(PipelineParams& params, const std::string& name, const std::string& text);
/// "name=value".
void setParam(PipelineParams& params, const std::string& assignment);

/// Throws std::invalid_argument naming the first key whose value is outside its range, or values that exclude each
/// other.
void validate(const PipelineParams& params);

/// One value of a YAML text.
struct NamedText {
  std::string name;  ///< dotted where the maps are nested
  std::string text;
  int line = 0;
};
/// The values in YAML: nested maps, dotted keys, or a node's parameters as `rosparam dump` and `dynparam dump` write
/// them. `name` is used in messages. Throws std::invalid_argument.
std::vector<NamedText> readYaml(const std::string& text, const std::string& name);
std::vector<NamedText> readYamlFile(const std::string& path);
/// Reads YAML over `params`. `preset: NAME` in it comes first; the parameters of the node are passed over. Throws
/// std::invalid_argument and changes nothing where a key or value is not right.
void loadYaml(PipelineParams& params, const std::string& text, const std::string& name);
/// Every parameter as YAML that loadYaml() takes.
std::string toYaml(const PipelineParams& params);

/// Names of the presets built in from config/*.yaml: "fast", "paper", ...
std::vector<std::string> presetNames();
bool isPreset(const std::string& name);
/// A built-in preset by name, or a YAML file by path. Throws std::invalid_argument naming what exists.
PipelineParams loadPreset(const std::string& name_or_file);
/// Changes to a preset and keeps what camera and machine ask for: the stages search and pipeline.
void usePreset(PipelineParams& params, const std::string& name);

}  // namespace fdp_stereo
