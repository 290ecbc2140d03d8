// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params_ros.hpp"
#include "reconfigure_server.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include <dynamic_reconfigure/config_tools.h>
#include <fdp_stereo/DisparityConfig.h>
#include <gtest/gtest.h>

namespace fdp_stereo {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigTools;

NodeSettings initial() { return {}; }

/// All that can be edited.
Config configOf(const NodeSettings& settings) {
  Config config;
  toConfig(settings, config);
  return config;
}

TEST(ApplyConfig, TakesValuesOfEveryKind) {
  Config edits;
  ConfigTools::appendParameter(edits, "min_disparity", -8);
  ConfigTools::appendParameter(edits, "hole_filling_enabled", true);
  ConfigTools::appendParameter(edits, "semi_global_p2", 6.5);
  ConfigTools::appendParameter(edits, "optimizer_type", 0);
  ConfigTools::appendParameter(edits, "max_rate", 7.5);
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, initial(), messages);
  EXPECT_TRUE(messages.empty());
  EXPECT_EQ(settings.pipeline.search.min, -8);
  EXPECT_TRUE(settings.pipeline.hole_filling.enabled);
  EXPECT_DOUBLE_EQ(settings.pipeline.semi_global.p2, 6.5);
  EXPECT_EQ(settings.pipeline.optimizer, OptimizerType::kWinnerTakesAll);
  EXPECT_DOUBLE_EQ(settings.node.max_rate_hz, 7.5);
  EXPECT_EQ(settings.revision, 1U);
}

TEST(ApplyConfig, AnEditThatChangesNothingIsNoRevision) {
  std::vector<std::string> messages;
  EXPECT_EQ(applyConfig(configOf(initial()), initial(), messages).revision, 0U);
  EXPECT_TRUE(messages.empty());
}

TEST(ApplyConfig, ClampsAndSaysSo) {
  Config edits;
  ConfigTools::appendParameter(edits, "disparity_range", 99999);
  ConfigTools::appendParameter(edits, "max_age", -1.0);
  ConfigTools::appendParameter(edits, "optimizer_type", 77);
  ConfigTools::appendParameter(edits, "semi_global_p1", std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, initial(), messages);
  EXPECT_EQ(settings.pipeline.search.count, 1024);
  EXPECT_DOUBLE_EQ(settings.node.max_age_s, 0.0);
  EXPECT_EQ(settings.pipeline.optimizer, OptimizerType::kLocalExpansion);
  EXPECT_DOUBLE_EQ(settings.pipeline.semi_global.p1, initial().pipeline.semi_global.p1);
  ASSERT_EQ(messages.size(), 4U);
  EXPECT_NE(messages[0].find("disparity_range = 99999"), std::string::npos) << messages[0];
  EXPECT_NE(messages[0].find("1024"), std::string::npos) << messages[0];
}

TEST(ApplyConfig, WhatDoesNotGoTogetherStaysAsItWas) {
  Config edits;
  ConfigTools::appendParameter(edits, "matching_cost_census_width", 8);
  ConfigTools::appendParameter(edits, "disparity_range", 32);
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, initial(), messages);
  const int before = initial().pipeline.matching_cost.census.window_width;
  EXPECT_EQ(settings.pipeline.matching_cost.census.window_width, before);
  EXPECT_EQ(settings.pipeline.search.count, 32) << "the good edit beside it is taken";
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("matching_cost_census_width stays " + std::to_string(before)), std::string::npos)
      << messages[0];
  EXPECT_NE(messages[0].find("odd"), std::string::npos) << messages[0];
}

TEST(ApplyConfig, OrderOfEditsThatNeedEachOtherDoesNotMatter) {
  Config edits;  // p2 must not be below p1
  ConfigTools::appendParameter(edits, "semi_global_p1", 4.0);
  ConfigTools::appendParameter(edits, "semi_global_p2", 6.0);
  ConfigTools::appendParameter(edits, "matching_cost_census_width", 8);
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, initial(), messages);
  EXPECT_DOUBLE_EQ(settings.pipeline.semi_global.p1, 4.0);
  EXPECT_DOUBLE_EQ(settings.pipeline.semi_global.p2, 6.0);
  EXPECT_EQ(settings.pipeline.matching_cost.census.window_width, 5);
  EXPECT_EQ(messages.size(), 1U);
}

TEST(ApplyConfig, DepthLimitsGoTogether) {
  Config edits;
  ConfigTools::appendParameter(edits, "min_depth", 5.0);
  ConfigTools::appendParameter(edits, "max_depth", 2.0);
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, initial(), messages);
  EXPECT_NO_THROW(validate(settings));
  EXPECT_EQ(messages.size(), 1U);
}

TEST(ApplyConfig, NamesWhatItDoesNotKnow) {
  Config edits;
  ConfigTools::appendParameter(edits, "correlation_window_size", 15);
  ConfigTools::appendParameter(edits, "P1", 200.0);
  ConfigTools::appendParameter(edits, "hole_fillnig_enabled", true);
  ConfigTools::appendParameter(edits, "stereo_algorithm", std::string("bm"));
  std::vector<std::string> messages;
  EXPECT_EQ(applyConfig(edits, initial(), messages).revision, 0U);
  ASSERT_EQ(messages.size(), 1U) << "one message for all";
  for (const char* part :
       {"'correlation_window_size' (use matching_cost_census_width", "'P1' (use semi_global_p1",
        "'hole_fillnig_enabled' (did you mean 'hole_filling_enabled'?)", "'stereo_algorithm' (use"}) {
    EXPECT_NE(messages[0].find(part), std::string::npos) << messages[0];
  }
}

TEST(ApplyRosparam, OneMessageForAYamlOfStereoImageProc) {
  XmlRpc::XmlRpcValue values;
  for (const char* name :
       {"P1", "P2", "prefilter_size", "prefilter_cap", "correlation_window_size", "texture_threshold",
        "stereo_algorithm", "fullDP", "downsampling_factor", "use_system_default_qos"}) {
    values[name] = 1;
  }
  values["disparity_range"] = 96;
  std::vector<std::string> messages;
  EXPECT_EQ(applyRosparam(values, initial(), {}, messages).pipeline.search.count, 96);
  ASSERT_EQ(messages.size(), 1U);
  for (auto& [name, value] : values) {
    if (name == "disparity_range") continue;
    EXPECT_NE(messages[0].find("'" + name + "' ("), std::string::npos) << messages[0];
  }
  EXPECT_EQ(messages[0].find("did you mean"), std::string::npos) << messages[0];
  EXPECT_NE(messages[0].find("docs/migration.md"), std::string::npos) << messages[0];
}

TEST(ApplyConfig, APresetKeepsSearchMachineAndNode) {
  NodeSettings before = initial();
  before.pipeline.search = {-4, 48};
  before.pipeline.threads = 3;
  before.node.max_rate_hz = 5.0;
  Config edits;
  ConfigTools::appendParameter(edits, "preset", std::string("accurate"));
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, before, messages);
  EXPECT_TRUE(messages.empty());
  EXPECT_EQ(settings.preset, "accurate");
  EXPECT_EQ(settings.revision, 1U);
  EXPECT_EQ(settings.pipeline.optimizer, OptimizerType::kLocalExpansion);
  EXPECT_EQ(settings.pipeline.search.min, -4);
  EXPECT_EQ(settings.pipeline.threads, 3);
  EXPECT_DOUBLE_EQ(settings.node.max_rate_hz, 5.0);
}

TEST(ApplyConfig, APresetMayComeWithEditsAndWithAllOldValues) {
  Config edits = configOf(initial());  // as a client sends that knows no single edits
  for (auto& entry : edits.strs) entry.value = "accurate";
  for (auto& entry : edits.ints) {
    if (entry.name == "disparity_range") entry.value = 77;
  }
  std::vector<std::string> messages;
  const NodeSettings settings = applyConfig(edits, initial(), messages);
  EXPECT_EQ(settings.preset, "accurate");
  EXPECT_EQ(settings.pipeline.search.count, 77);
}

TEST(ApplyConfig, ThePresetIsCustomWhileItsValuesAreChanged) {
  std::vector<std::string> messages;
  Config edits;
  ConfigTools::appendParameter(edits, "semi_global_p1", 1.0);
  const NodeSettings tuned = applyConfig(edits, initial(), messages);
  EXPECT_EQ(tuned.preset, kCustomPreset);
  Config back;
  ConfigTools::appendParameter(back, "preset", std::string("fast"));
  EXPECT_EQ(toYaml(applyConfig(back, tuned, messages).pipeline), toYaml(initial().pipeline));
  Config range;
  ConfigTools::appendParameter(range, "disparity_range", 99);
  EXPECT_EQ(applyConfig(range, initial(), messages).preset, "fast");
  EXPECT_TRUE(messages.empty());
  Config wrong;
  ConfigTools::appendParameter(wrong, "preset", std::string("fats"));
  EXPECT_EQ(applyConfig(wrong, tuned, messages).revision, tuned.revision);
  EXPECT_EQ(messages.size(), 1U);
}

TEST(ApplyRosparam, FlatNamesMapsWordsAndNumbers) {
  XmlRpc::XmlRpcValue values;
  values["disparity_range"] = 48;
  values["semi_global_p2"] = 5;  // a whole number for a real one
  values["optimizer_type"] = std::string("winner_takes_all");
  values["hole_filling"]["enabled"] = true;
  values["matching_cost"]["type"] = std::string("ad_census");
  values["queue_size"] = 3;
  std::vector<std::string> messages;
  const NodeSettings settings = applyRosparam(values, initial(), {"queue_size"}, messages);
  EXPECT_TRUE(messages.empty()) << messages.front();
  EXPECT_EQ(settings.pipeline.search.count, 48);
  EXPECT_DOUBLE_EQ(settings.pipeline.semi_global.p2, 5.0);
  EXPECT_EQ(settings.pipeline.optimizer, OptimizerType::kWinnerTakesAll);
  EXPECT_TRUE(settings.pipeline.hole_filling.enabled);
  EXPECT_EQ(settings.pipeline.matching_cost.type, MatchingCostType::kAdCensus);
}

TEST(ApplyRosparam, KeepsGoodValuesBesideBadOnes) {
  XmlRpc::XmlRpcValue values;
  values["disparity_range"] = std::string("abc");
  values["min_disparity"] = 4;
  values["speckle_size"][0] = 1;  // a list
  values["hole_filling"]["enabeld"] = true;
  values["unknown"] = 1;
  std::vector<std::string> messages;
  const NodeSettings settings = applyRosparam(values, initial(), {}, messages);
  EXPECT_EQ(settings.pipeline.search.count, initial().pipeline.search.count);
  EXPECT_EQ(settings.pipeline.search.min, 4);
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_NE(messages[2].find("'hole_filling.enabeld' (did you mean 'hole_filling.enabled'?), 'unknown'"),
            std::string::npos)
      << messages[2];
}

/// A file that `rosparam dump` or `dynparam dump` wrote, given as ~params.
TEST(ApplyYaml, ADumpSetsPipelineAndNode) {
  NodeSettings tuned = initial();
  tuned.pipeline.search = {-16, 96};
  tuned.pipeline.semi_global.p1 = 1.25;
  tuned.node.max_depth_m = 12.5;
  tuned.preset = kCustomPreset;
  const Config dump = configOf(tuned);
  std::ostringstream yaml;
  yaml << "!!python/object/new:dynamic_reconfigure.encoding.Config\ndictitems:\n  groups: {id: 0}\n  queue_size: 5\n";
  for (const auto& entry : dump.bools) yaml << "  " << entry.name << ": " << (entry.value ? "true" : "false") << "\n";
  for (const auto& entry : dump.ints) yaml << "  " << entry.name << ": " << entry.value << "\n";
  for (const auto& entry : dump.doubles) yaml << "  " << entry.name << ": " << entry.value << "\n";
  for (const auto& entry : dump.strs) yaml << "  " << entry.name << ": " << entry.value << "\n";
  std::vector<std::string> messages;
  const NodeSettings loaded =
      applyYaml(readYaml(yaml.str() + "state: []\n", "dump"), initial(), {"queue_size", "preset"}, messages);
  EXPECT_TRUE(messages.empty()) << messages.front();
  EXPECT_EQ(toYaml(loaded.pipeline), toYaml(tuned.pipeline));
  EXPECT_EQ(loaded.preset, kCustomPreset);
  EXPECT_DOUBLE_EQ(loaded.node.max_depth_m, 12.5);
  PipelineParams offline;
  loadYaml(offline, yaml.str(), "dump");
  EXPECT_EQ(toYaml(offline), toYaml(tuned.pipeline)) << "the same file is a preset of the tools";
}

TEST(ApplyYaml, APresetInItComesFirst) {
  std::vector<std::string> messages;
  const NodeSettings settings =
      applyYaml(readYaml("semi_global_p1: 0.7\npreset: paper\n", "based"), initial(), {"preset"}, messages);
  EXPECT_TRUE(messages.empty());
  EXPECT_EQ(settings.pipeline.matching_cost.scales, 3);
  EXPECT_DOUBLE_EQ(settings.pipeline.semi_global.p1, 0.7);
}

TEST(ApplyRosparam, AnythingButAMapIsNothing) {
  std::vector<std::string> messages;
  EXPECT_EQ(applyRosparam(XmlRpc::XmlRpcValue(7), initial(), {}, messages).revision, 0U);
}

TEST(Parameters, ADumpLoadsAgain) {
  NodeSettings tuned = initial();
  tuned.pipeline.search = {-16, 96};
  tuned.pipeline.matching_cost.type = MatchingCostType::kBirchfieldTomasi;
  tuned.node.max_depth_m = 12.5;
  Config dump;
  toConfig(tuned, dump);
  std::vector<std::string> messages;
  const NodeSettings loaded = applyConfig(dump, initial(), messages);
  EXPECT_TRUE(messages.empty());
  EXPECT_EQ(toYaml(loaded.pipeline), toYaml(tuned.pipeline));
  EXPECT_DOUBLE_EQ(loaded.node.max_depth_m, 12.5);
}

TEST(Parameters, RosNamesAreUniqueAndNamesOfStereoImageProcAreKept) {
  NodeSettings settings;
  std::set<std::string> names;
  for (const auto& ref : liveParamList(settings)) EXPECT_TRUE(names.insert(ref.ros_name).second) << ref.ros_name;
  for (const char* name :
       {"min_disparity", "disparity_range", "uniqueness_ratio", "speckle_size", "speckle_range", "disp12MaxDiff"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

/// The generated class, as rqt_reconfigure sees it, against the list.
TEST(CfgFile, DefaultsAndRangesAreThoseOfTheList) {
  NodeSettings settings = initial();
  const auto description = DisparityConfig::__getDescriptionMessage__();
  Config generated = description.dflt;
  Config expected = description.dflt;
  toConfig(settings, expected);
  std::string preset;
  EXPECT_TRUE(ConfigTools::getParameter(generated, "preset", preset));
  EXPECT_EQ(preset, kDefaultPreset);
  EXPECT_EQ(generated.ints.size() + generated.doubles.size() + generated.bools.size(), liveParamList(settings).size());
  EXPECT_EQ(expected.ints.size(), generated.ints.size());
  for (const auto& ref : liveParamList(settings)) {
    double real = 0.0;
    int whole = 0;
    if (std::holds_alternative<double*>(ref.value)) {
      ASSERT_TRUE(ConfigTools::getParameter(generated, ref.ros_name, real)) << ref.ros_name;
      EXPECT_DOUBLE_EQ(real, *std::get<double*>(ref.value)) << ref.ros_name;
      EXPECT_TRUE(ConfigTools::getParameter(description.min, ref.ros_name, real));
      EXPECT_DOUBLE_EQ(real, ref.min) << ref.ros_name;
      EXPECT_TRUE(ConfigTools::getParameter(description.max, ref.ros_name, real));
      EXPECT_DOUBLE_EQ(real, ref.max) << ref.ros_name;
    } else if (!std::holds_alternative<bool*>(ref.value)) {
      ASSERT_TRUE(ConfigTools::getParameter(generated, ref.ros_name, whole)) << ref.ros_name;
      EXPECT_TRUE(ConfigTools::getParameter(description.min, ref.ros_name, whole));
      EXPECT_EQ(whole, static_cast<int>(ref.min)) << ref.ros_name;
      EXPECT_TRUE(ConfigTools::getParameter(description.max, ref.ros_name, whole));
      EXPECT_EQ(whole, static_cast<int>(ref.max)) << ref.ros_name;
    }
  }
}

/// As rqt_reconfigure shows it: groups sorted by name, those of type collapse closed where their state is false.
TEST(CfgFile, WhatOneTunesComesFirst) {
  auto groups = DisparityConfig::__getDescriptionMessage__().groups;
  std::sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  std::vector<std::string> basic;
  std::size_t tuned = 0;
  bool experts = false;
  for (const auto& group : groups) {
    if (group.id == 0) {
      EXPECT_TRUE(group.parameters.empty());
      continue;
    }
    experts = experts || group.type == "collapse";
    EXPECT_EQ(group.type, experts ? "collapse" : "") << group.name << ": all experts' groups come last";
    for (const auto& state : initialGroups()) {
      if (state.name != group.name) continue;
      EXPECT_EQ(state.state != 0, !experts) << group.name;
    }
    if (experts) continue;
    basic.push_back(group.name);
    tuned += group.parameters.size();
  }
  EXPECT_EQ(basic, (std::vector<std::string>{"basic_1_search", "basic_2_smoothness", "basic_3_filters", "basic_4_seeds",
                                             "basic_5_node"}));
  EXPECT_LE(tuned, 25U);
  EXPECT_GE(tuned, 20U);
}

TEST(Parameters, RangesSuitASliderOfAHundredSteps) {
  NodeSettings settings;
  for (const ParamRef& ref : liveParamList(settings)) {
    if (isWhole(ref) || ref.min <= 0.0) continue;
    EXPECT_LE(ref.max / ref.min, 1000.0) << ref.ros_name;
  }
}

/// A dump of the node is a preset of the tools, which pass over what belongs to the node.
TEST(Parameters, ToolsKnowWhatBelongsToTheNode) {
  NodeSettings settings;
  for (const ParamRef& ref : liveParamList(settings)) {
    PipelineParams params;
    EXPECT_NO_THROW(loadYaml(params, ref.ros_name + ": " + toString(ref), "dump"));
    EXPECT_NO_THROW(loadYaml(params, ref.key + ": " + toString(ref), "dump"));
  }
}

}  // namespace
}  // namespace fdp_stereo
