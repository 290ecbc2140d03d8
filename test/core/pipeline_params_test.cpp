// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/pipeline_params.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

namespace fdp_stereo {
namespace {

/// The message of the std::invalid_argument that `call` throws; "" where it throws none.
template <typename Call>
std::string messageOf(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "' lacks '" << part << "'";
}

TEST(ParamList, HasUniqueKeysWithRangeAndText) {
  PipelineParams params;
  std::set<std::string> keys;
  std::set<std::string> ros_names;
  for (const ParamRef& ref : paramList(params)) {
    EXPECT_TRUE(keys.insert(ref.key).second) << ref.key;
    EXPECT_TRUE(ros_names.insert(ref.ros_name).second) << ref.ros_name;
    EXPECT_EQ(ref.ros_name.find('.'), std::string::npos) << ref.ros_name;
    EXPECT_LT(ref.min, ref.max) << ref.key;
    EXPECT_GE(toNumber(ref), ref.min) << ref.key;
    EXPECT_LE(toNumber(ref), ref.max) << ref.key;
    ASSERT_FALSE(ref.text.empty()) << ref.key;
    EXPECT_EQ(ref.text.back(), '.') << ref.key;
  }
}

TEST(ParamList, StagesAreContiguous) {
  PipelineParams params;
  std::set<std::string> finished;
  std::string stage;
  for (const ParamRef& ref : paramList(params)) {
    const std::string next = ref.key.substr(0, ref.key.find('.'));
    if (next == stage) continue;
    EXPECT_TRUE(finished.insert(next).second) << next << " comes twice";
    stage = next;
  }
}

TEST(ParamList, RangesSuitASliderOfAHundredSteps) {
  PipelineParams params;
  for (const ParamRef& ref : paramList(params)) {
    if (isWhole(ref) || ref.min <= 0.0) continue;
    EXPECT_LE(ref.max / ref.min, 1000.0) << ref.key;
  }
}

TEST(ParamList, UsesTheNamesOfStereoImageProcWhereTheMeaningIsTheSame) {
  PipelineParams params;
  std::set<std::string> names;
  for (const ParamRef& ref : paramList(params)) names.insert(ref.ros_name);
  for (const char* name :
       {"min_disparity", "disparity_range", "uniqueness_ratio", "speckle_size", "speckle_range", "disp12MaxDiff"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
  EXPECT_EQ(names.count("matching_cost_type"), 1U);
}

TEST(SetParam, ReachesTheField) {
  PipelineParams params;
  setParam(params, "search.min_disparity=-12");
  setParam(params, "matching_cost.type", "ad_census");
  setParam(params, " speckle_filter.max_size = 3 ");
  setParam(params, "hole_filling.enabled=true");
  EXPECT_EQ(params.search.min, -12);
  EXPECT_EQ(params.matching_cost.type, MatchingCostType::kAdCensus);
  EXPECT_EQ(params.speckle_filter.max_size, 3);
  EXPECT_TRUE(params.hole_filling.enabled);
}

TEST(SetParam, TakesRosNamesAndIndicesOfChoicesToo) {
  PipelineParams params;
  setParam(params, "disparity_range=100");
  setParam(params, "speckle_size", "33");
  setParam(params, "optimizer_type", "0");
  EXPECT_EQ(params.search.count, 100);
  EXPECT_EQ(params.speckle_filter.max_size, 33);
  EXPECT_EQ(params.optimizer, OptimizerType::kWinnerTakesAll);
  for (const char* index : {"-1", "3", "1.0"}) {
    expectContains(messageOf([&] { setParam(params, "optimizer_type", index); }), "one of winner_takes_all");
  }
}

TEST(SetParam, EveryEntryTakesBothEndsOfItsRangeAndNothingBeyond) {
  PipelineParams params;
  for (const ParamRef& ref : paramList(params)) {
    if (std::holds_alternative<EnumRef>(ref.value) || std::holds_alternative<bool*>(ref.value)) continue;
    for (const double end : {ref.min, ref.max}) {
      setParam(params, ref.key,
               std::holds_alternative<int*>(ref.value) ? std::to_string(static_cast<int>(end)) : std::to_string(end));
      EXPECT_DOUBLE_EQ(toNumber(ref), end) << ref.key;
    }
    expectContains(messageOf([&] { setParam(params, ref.key, std::to_string(static_cast<int>(ref.max) + 1)); }),
                   ref.key + " = ");
    EXPECT_DOUBLE_EQ(toNumber(ref), ref.max) << "a refused value must not stick: " << ref.key;
  }
}

TEST(SetParam, RefusesWhatIsNotAValue) {
  PipelineParams params;
  for (const char* text : {"", "abc", "12x", " 12", "1.5", "99999999999", "nan", "0x10"}) {
    expectContains(messageOf([&] { setParam(params, "search.num_disparities", text); }),
                   "must be an integer from 1 to 1024 px");
  }
  for (const char* text : {"", "nan", "inf", "1e999", "0.5 ", "0,5"}) {
    expectContains(messageOf([&] { setParam(params, "matching_cost.alpha", text); }), "must be a number from 0 to 1");
  }
  expectContains(messageOf([&] { setParam(params, "optimizer.type", "sgm"); }), "one of winner_takes_all, semi_global");
  expectContains(messageOf([&] { setParam(params, "hole_filling.enabled", "maybe"); }), "true or false");
  expectContains(messageOf([&] { setParam(params, "hole_filling.enabled"); }), "stage.name=value");
}

TEST(SetParam, UnknownKeyNamesTheNearest) {
  PipelineParams params;
  EXPECT_EQ(messageOf([&] { setParam(params, "matching_cost.alhpa=1"); }),
            "unknown parameter 'matching_cost.alhpa', did you mean 'matching_cost.alpha'?");
  expectContains(messageOf([&] { setParam(params, "semi_globl.p1=1"); }), "'semi_global.p1'");
  expectContains(messageOf([&] { setParam(params, "disparity_rnage=1"); }), "did you mean 'disparity_range'?");
}

TEST(SetParam, NamesTheSuccessorsOfStereoImageProc) {
  PipelineParams params;
  for (const char* name : {"P1", "P2", "correlation_window_size", "stereo_algorithm"}) {
    const std::string advice = adviceFor(paramList(params), name);
    expectContains(advice, "use ");
    const std::string successor = advice.substr(4, advice.find_first_of(", ", 4) - 4);
    EXPECT_NE(findParam(paramList(params), successor), nullptr) << advice;
  }
  expectContains(messageOf([&] { setParam(params, "texture_threshold=10"); }), "'texture_threshold', not needed here");
}

TEST(Validate, AcceptsTheDefaultsAndEveryPreset) {
  EXPECT_NO_THROW(validate(PipelineParams{}));
  for (const std::string& name : presetNames()) EXPECT_NO_THROW(validate(loadPreset(name))) << name;
}

TEST(Validate, NamesTheFirstKeyOutsideItsRange) {
  PipelineParams params;
  params.search.count = 0;
  expectContains(messageOf([&] { validate(params); }), "search.num_disparities = '0'");
  params.search.count = 64;
  params.matching_cost.alpha = std::numeric_limits<double>::quiet_NaN();
  expectContains(messageOf([&] { validate(params); }), "matching_cost.alpha");
}

TEST(Validate, RefusesValuesThatExcludeEachOther) {
  const auto refused = [](const char* first, const char* second) {
    PipelineParams params;
    setParam(params, first);
    setParam(params, second);
    return messageOf([&] { validate(params); });
  };
  expectContains(refused("matching_cost.census_width=8", "matching_cost.census_height=7"), "must be odd");
  expectContains(refused("matching_cost.census_width=11", "matching_cost.census_height=7"), "2 to 65 pixels");
  expectContains(refused("matching_cost.census_width=1", "matching_cost.census_height=1"), "2 to 65 pixels");
  expectContains(refused("semi_global.p1=3", "semi_global.p2=2"), "semi_global.p1 = 3");
}

TEST(Yaml, RoundTripsEveryParameter) {
  PipelineParams params;
  for (const ParamRef& ref : paramList(params)) {
    if (const auto* choice = std::get_if<EnumRef>(&ref.value)) choice->set(static_cast<int>(ref.max));
    if (const auto* flag = std::get_if<bool*>(&ref.value)) **flag = !**flag;
    if (const auto* integer = std::get_if<int*>(&ref.value)) **integer = static_cast<int>(ref.max) - 1;
    if (const auto* real = std::get_if<double*>(&ref.value)) **real = ref.min + (ref.max - ref.min) / 3.0;
  }
  PipelineParams loaded;
  loadYaml(loaded, toYaml(params), "round trip");
  const std::vector<ParamRef> expected = paramList(params);
  const std::vector<ParamRef> actual = paramList(loaded);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(toNumber(actual[i]), toNumber(expected[i])) << actual[i].key;
}

TEST(Yaml, TakesNestedAndDottedKeysAndKeepsTheRest) {
  PipelineParams params;
  params.matching_cost.alpha = 0.5;
  loadYaml(params, "semi_global: {p1: 1.5}\nsearch.num_disparities: 96\n", "mixed");
  EXPECT_DOUBLE_EQ(params.semi_global.p1, 1.5);
  EXPECT_EQ(params.search.count, 96);
  EXPECT_DOUBLE_EQ(params.matching_cost.alpha, 0.5);
  EXPECT_NO_THROW(loadYaml(params, "", "empty"));
  EXPECT_NO_THROW(loadYaml(params, "# nothing\n", "comment"));
}

/// What `rosparam dump` and `dynparam dump` write of a tuned node.
TEST(Yaml, TakesTheDumpOfANode) {
  const std::string values =
      "  disparity_range: 96\n  hole_filling_enabled: true\n  optimizer_type: 0\n  semi_global_p2: 2.5\n"
      "  max_rate: 5.0\n  seeds_points_trust: 0.9\n  preset: custom\n";
  const std::string rosparam = values +
                               "  queue_size: 5\n  approximate_sync: false\n  params: 'search: {x: 1}'\n"
                               "  left_mask: ''\n  right_mask: arm.png\n  rectify: internal\n  nearest: 0.5\n"
                               "  approximate_sync_tolerance: 0.0\n  image_transport: raw\n  seeds_fixed_frame: odom\n"
                               "  diagnostic_period: 1.0\n  watch_period: 15.0\n";
  const std::string dynparam = "!!python/object/new:dynamic_reconfigure.encoding.Config\ndictitems:\n" + values +
                               "  groups: !!python/object/new:dynamic_reconfigure.encoding.Config\n    dictitems:\n"
                               "      groups: {}\n      id: 0\n    state: []\nstate: []\n";
  for (const std::string& dump : {rosparam, dynparam}) {
    PipelineParams params;
    loadYaml(params, dump, "dump");
    EXPECT_EQ(params.search.count, 96);
    EXPECT_TRUE(params.hole_filling.enabled);
    EXPECT_EQ(params.optimizer, OptimizerType::kWinnerTakesAll);
    EXPECT_DOUBLE_EQ(params.semi_global.p2, 2.5);
  }
}

TEST(Yaml, ReportsMisspeltNamesOfTheNode) {
  for (const std::string name : {"seeds_points_trsut", "seeds.point_trust", "node.max_rate", "seeds_", "max_rat"}) {
    PipelineParams params;
    try {
      loadYaml(params, "semi_global.p1: 0.7\n" + name + ": 1\n", "file");
      ADD_FAILURE() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("file:2: unknown parameter '" + name + "'"), std::string::npos)
          << error.what();
    }
  }
}

TEST(Yaml, NamesAllUnknownParametersAtOnce) {
  PipelineParams params;
  const std::string message =
      messageOf([&] { loadYaml(params, "disparity_range: 96\nP1: 200\nP2: 400\nprefilter_cap: 31\n", "sgbm.yaml"); });
  expectContains(message, "sgbm.yaml:2: unknown parameters 'P1' (use semi_global_p1, in other units), 'P2' (use ");
  expectContains(message, "'prefilter_cap' (not needed here); docs/migration.md");
  expectContains(messageOf([&] { setParam(params, "P1", "200"); }), "use semi_global_p1");
}

TEST(Yaml, APresetInItComesFirst) {
  PipelineParams params;
  params.search.count = 33;
  params.threads = 2;
  loadYaml(params, "semi_global.p1: 0.7\npreset: paper\n", "based");
  EXPECT_EQ(params.matching_cost.scales, 3);
  EXPECT_DOUBLE_EQ(params.semi_global.p1, 0.7);
  EXPECT_EQ(params.search.count, 33) << "camera and machine decide";
  EXPECT_EQ(params.threads, 2);
}

TEST(Yaml, ErrorsNameFileLineAndKey) {
  PipelineParams params;
  EXPECT_EQ(messageOf([&] { loadYaml(params, "search:\n  min_disparity: x\n", "a.yaml"); }),
            "a.yaml:2: search.min_disparity = 'x': must be an integer from -1024 to 1024 px");
  expectContains(messageOf([&] { loadYaml(params, "\nsearch.nums: 3\n", "a.yaml"); }),
                 "a.yaml:2: unknown parameter 'search.nums'");
  expectContains(messageOf([&] { loadYaml(params, "search: 3\n", "a.yaml"); }), "unknown parameter 'search'");
  expectContains(messageOf([&] { loadYaml(params, "search: [1, 2]\n", "a.yaml"); }), "must be a map");
  expectContains(messageOf([&] { loadYaml(params, "search: {min_disparity: ~}\n", "a.yaml"); }), "a.yaml:1");
  expectContains(messageOf([&] { loadYaml(params, "just words\n", "a.yaml"); }), "must be a map");
  expectContains(messageOf([&] { loadYaml(params, "search: {min_disparity: 1\n", "a.yaml"); }), "a.yaml:");
  expectContains(messageOf([&] { loadYaml(params, "pipeline.threads: 1\npipeline: {threads: 2}\n", "a.yaml"); }),
                 "twice");
}

TEST(Yaml, ARefusedFileChangesNothing) {
  PipelineParams params;
  EXPECT_THROW(loadYaml(params, "search.num_disparities: 96\nsearch.min_disparity: x\n", "a"), std::invalid_argument);
  EXPECT_EQ(params.search.count, PipelineParams{}.search.count);
}

TEST(Yaml, SurvivesHostileInput) {
  PipelineParams params;
  EXPECT_THROW(loadYaml(params, "&a {search: *a}\n", "cycle"), std::invalid_argument);
  EXPECT_THROW(loadYaml(params, std::string(2U << 20, 'x'), "huge"), std::invalid_argument);
  EXPECT_THROW(loadYaml(params, std::string(10000, '['), "deep"), std::invalid_argument);
  EXPECT_THROW(loadYaml(params, "a: !!python/object/apply:os.system ['true']\n", "tag"), std::invalid_argument);
}

TEST(Preset, FastIsTheDefault) { EXPECT_EQ(toYaml(loadPreset("fast")), toYaml(PipelineParams{})); }

TEST(Preset, FilesListOnlyWhatDiffersFromTheDefaults) {
  for (const char* file :
       {"config/fast", "config/light", "config/accurate", "config/paper", "benchmark/localexp_reference"}) {
    PipelineParams defaults;
    const std::vector<ParamRef> refs = paramList(defaults);
    for (const NamedText& line : readYamlFile(FDP_STEREO_SOURCE_DIR "/" + std::string(file) + ".yaml")) {
      const ParamRef* ref = findParam(refs, line.name);
      ASSERT_NE(ref, nullptr) << file << ": " << line.name;
      const double before = toNumber(*ref);
      setFromString(*ref, line.text);
      EXPECT_NE(toNumber(*ref), before) << file << ":" << line.line << ": " << line.name << " is the default";
    }
  }
}

TEST(Preset, PaperHasThePublishedValuesAndNoLaterStage) {
  const PipelineParams paper = loadPreset("paper");
  EXPECT_EQ(paper.matching_cost.scales, 3);
  EXPECT_DOUBLE_EQ(paper.matching_cost.alpha, 0.8);
  EXPECT_DOUBLE_EQ(paper.matching_cost.lambda_rho, 10.0);
  EXPECT_DOUBLE_EQ(paper.matching_cost.lambda_census, 30.0);
  EXPECT_DOUBLE_EQ(paper.feature_matching.max_ratio, 0.6);
  EXPECT_EQ(paper.disparity_propagation.window, 5);
  EXPECT_NEAR(paper.disparity_propagation.gamma, 10.0 / 3.0, 1e-3);
  EXPECT_FALSE(paper.row_alignment.enabled);
}

TEST(Preset, ComesFromAFileToo) {
  const std::string path = testing::TempDir() + "/preset_test.yaml";
  std::ofstream(path) << "search.num_disparities: 33\n";
  EXPECT_EQ(loadPreset(path).search.count, 33);
  expectContains(messageOf([] { loadPreset("fats"); }), "fast");
  expectContains(messageOf([] { loadPreset("/does/not/exist.yaml"); }), "/does/not/exist.yaml: cannot be read");
  expectContains(messageOf([] { loadPreset("/"); }), "/: cannot be read");
}

}  // namespace
}  // namespace fdp_stereo
