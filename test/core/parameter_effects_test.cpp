// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Every parameter of the list changes something in the result of some pair.
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/pipeline.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

/// Parameters that change no result of these pairs, and why.
const std::map<std::string, std::string> kExceptions = {
    {"pipeline.threads", "no result may depend on it"},
    {"temporal.enabled", "of streams, not of one pair: temporal_test"},
    {"matching_cost.adapt", "good images stay as they are: cost_views_test"},
    {"pipeline.max_memory_mb", "refuses pairs that are larger than these: pipeline_test"},
};

constexpr int kRows = 72;
constexpr int kCols = 112;

struct Frame {
  cv::Mat left;
  cv::Mat right;
  Seeds seeds;
};

/// A square before a wall, an even patch on it and noise over both, the right view turned a little so that its rows are
/// bent, and seeds of another sensor of which every fifth is wrong.
Frame makeFrame(unsigned seed) {
  const reference::RenderedPair pair = reference::renderPair(kRows, kCols, 4, 11, seed);
  Frame frame{pair.left.clone(), cv::Mat(), {}};
  frame.left(cv::Rect(8, 8, 20, 14)).setTo(cv::Scalar(90, 120, 100));
  const cv::Mat turn = cv::getRotationMatrix2D({kCols / 2.0F, kRows / 2.0F}, 0.7, 1.0);
  cv::warpAffine(pair.right, frame.right, turn, pair.right.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  cv::Mat noise(kRows, kCols, CV_8UC3);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::UNIFORM, 0, 24);
  frame.right += noise;
  for (int y = 4; y < kRows; y += 8) {
    for (int x = 8; x < kCols; x += 8) {
      Seed point;
      point.x = static_cast<float>(x);
      point.y = static_cast<float>(y);
      point.d = pair.truth.at<float>(y, x) + (frame.seeds.size() % 5 == 0 ? 3.0F : 0.2F);
      point.trust = 0.9F;
      point.source = SeedSource::kPoints;
      frame.seeds.push_back(point);
    }
  }
  return frame;
}

void append(std::vector<double>& numbers, const cv::Mat& map) {
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const double value = map.at<float>(y, x);
      numbers.push_back(std::isnan(value) ? -1e9 : value);
    }
  }
}

void append(std::vector<double>& numbers, const Seeds& seeds) {
  numbers.push_back(static_cast<double>(seeds.size()));
  for (const Seed& seed : seeds) numbers.insert(numbers.end(), {seed.x, seed.y, seed.d, seed.trust});
}

/// All that can be seen of a run over two pairs, as numbers; the length of the message where it is refused.
std::vector<double> outcome(const PipelineParams& params) {
  static const Frame frames[] = {makeFrame(5), makeFrame(8)};
  std::vector<double> numbers;
  try {
    Pipeline pipeline(params);
    for (const Frame& frame : frames) {
      const PipelineResult result = pipeline.run(frame.left, frame.right, frame.seeds);
      append(numbers, result.disparity);
      append(numbers, result.confidence);
      for (const FeatureMatch& match : result.matches) {
        numbers.insert(numbers.end(), {match.left.x, match.left.y, match.right.x, match.right.y, match.trust});
      }
      append(numbers, result.seeds);
      append(numbers, result.rejected_seeds);
      append(numbers, result.quasi_dense_seeds);
      numbers.push_back(static_cast<double>(result.row_alignment.warning.size()));
      numbers.insert(numbers.end(), result.energies.begin(), result.energies.end());
    }
  } catch (const std::invalid_argument& error) {
    numbers.push_back(static_cast<double>(std::string(error.what()).size()));
  }
  return numbers;
}

/// What the parameters are tried on: together, these use every stage and form.
std::vector<PipelineParams> setups() {
  std::vector<PipelineParams> all;
  PipelineParams setup;
  setup.search = {0, 24};
  all.push_back(setup);
  setup.sparse_disparity.features = true;
  setup.disparity_propagation.form = PropagationForm::kWindow;
  setup.feature_matching.detector = FeatureDetector::kSift;
  setup.optimizer = OptimizerType::kWinnerTakesAll;
  setup.hole_filling.enabled = true;
  all.push_back(setup);
  setup.matching_cost.type = MatchingCostType::kLearned;
  all.push_back(setup);
  setup = loadPreset("accurate");
  setup.search = {0, 24};
  setup.local_expansion.disparity_steps = 1;
  all.push_back(setup);
  return all;
}

std::vector<double> valuesOf(const ParamRef& ref) {
  if (std::holds_alternative<bool*>(ref.value)) return {1.0 - toNumber(ref)};
  std::vector<double> values;
  if (std::holds_alternative<EnumRef>(ref.value)) {
    for (double value = ref.min; value <= ref.max; ++value) values.push_back(value);
    return values;
  }
  for (const double share : {1e-5, 0.5, 0.0, 1.0}) {
    const double value = ref.min + share * (ref.max - ref.min);
    values.push_back(isWhole(ref) ? std::round(value) : value);
  }
  if (isWhole(ref)) values.insert(values.end(), {toNumber(ref) + 2.0, toNumber(ref) - 2.0});
  return values;
}

bool valid(const PipelineParams& params) {
  try {
    validate(params);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

bool hasEffect(std::size_t index) {
  static const std::vector<PipelineParams> kSetups = setups();
  static std::map<std::size_t, std::vector<double>> expected;
  for (std::size_t i = 0; i < kSetups.size(); ++i) {
    PipelineParams setup = kSetups[i];
    const ParamRef ref = paramList(setup)[index];
    const double before = toNumber(ref);
    const bool of_planes = ref.key.rfind("local_expansion.", 0) == 0;
    if (of_planes != (setup.optimizer == OptimizerType::kLocalExpansion)) continue;
    if (expected.count(i) == 0) expected[i] = outcome(setup);
    for (const double value : valuesOf(ref)) {
      setFromNumber(ref, value);
      if (value != before && valid(setup) && outcome(setup) != expected[i]) return true;
    }
  }
  return false;
}

TEST(ParameterEffects, EveryParameterChangesSomething) {
  PipelineParams params;
  const std::vector<ParamRef> refs = paramList(params);
  for (std::size_t i = 0; i < refs.size(); ++i) {
    if (kExceptions.count(refs[i].key) != 0) continue;
    EXPECT_TRUE(hasEffect(i)) << refs[i].key << " changes nothing";
  }
}

TEST(ParameterEffects, ExceptionsAreParameters) {
  PipelineParams params;
  for (const auto& [key, reason] : kExceptions) EXPECT_NE(findParam(paramList(params), key), nullptr) << key;
}

}  // namespace
}  // namespace fdp_stereo
