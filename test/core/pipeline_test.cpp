// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/pipeline.hpp"
#include "fdp_stereo/io.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "evaluation/evaluation.hpp"
#include "evaluation/scene.hpp"
#include "fdp_stereo/cost_scale.hpp"
#include "fdp_stereo/io.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

const reference::RenderedPair& rendered() {
  static const reference::RenderedPair pair = reference::renderPair(120, 200, 6, 15, 5);
  return pair;
}

/// A preset for the rendered pair. Local expansion takes seconds even there and has tests of its own: what is tested
/// here are the stages around the optimiser, so semi-global matching stands in for it.
PipelineParams paramsOf(const std::string& preset) {
  PipelineParams params = loadPreset(preset);
  params.search = {0, 32};
  params.optimizer = OptimizerType::kSemiGlobal;
  return params;
}

class EveryPreset : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Pipeline, EveryPreset, testing::Values("fast", "paper"));

TEST_P(EveryPreset, FindsTheRenderedDisparities) {
  PipelineParams params = paramsOf(GetParam());
  params.hole_filling.enabled = true;
  const PipelineResult result = Pipeline(params).run(rendered().left, rendered().right);
  const DisparityErrors errors = evaluateDisparity(result.disparity, rendered().truth, rendered().visible);
  EXPECT_GT(errors.density, 99.5);
  EXPECT_LT(errors.bad[3], 4.0) << "share off by more than 1 px";
  EXPECT_LT(errors.bad[1], 8.0) << "share off by more than a quarter";
}

TEST_P(EveryPreset, ThreadsGiveTheSameBits) {
  PipelineParams params = paramsOf(GetParam());
  params.threads = 1;
  const PipelineResult expected = Pipeline(params).run(rendered().left, rendered().right);
  for (const int threads : {2, 4}) {
    params.threads = threads;
    const PipelineResult actual = Pipeline(params).run(rendered().left, rendered().right);
    EXPECT_EQ(reference::differingPixels(actual.disparity, expected.disparity), 0);
    EXPECT_EQ(reference::differingPixels(actual.confidence, expected.confidence), 0);
  }
}

using PipelineKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(PipelineKernel);

TEST_P(PipelineKernel, GivesTheSameBits) {
  for (const char* preset : {"fast", "paper"}) {
    const auto run = [&] { return Pipeline(paramsOf(preset)).run(rendered().left, rendered().right); };
    const PipelineResult actual = onThisSet(run);
    const PipelineResult expected = onBaseline(run);
    EXPECT_EQ(reference::differingPixels(actual.disparity, expected.disparity), 0);
    EXPECT_EQ(reference::differingPixels(actual.confidence, expected.confidence), 0);
  }
}

TEST(Pipeline, RefusesAnUnknownInstructionSet) {
  const char* const wanted = std::getenv("FDP_STEREO_SIMD");
  const std::string before = wanted == nullptr ? "" : wanted;
  setenv("FDP_STEREO_SIMD", "avx", 1);
  std::string message;
  try {
    Pipeline pipeline(paramsOf("fast"));
  } catch (const std::invalid_argument& error) {
    message = error.what();
  }
  before.empty() ? unsetenv("FDP_STEREO_SIMD") : setenv("FDP_STEREO_SIMD", before.c_str(), 1);
  EXPECT_NE(message.find("FDP_STEREO_SIMD is 'avx'"), std::string::npos) << message;
  EXPECT_NE(message.find("baseline, avx2 or avx512"), std::string::npos) << message;
}

TEST_P(EveryPreset, ASecondFrameGivesTheSameAsTheFirst) {
  Pipeline pipeline(paramsOf(GetParam()));
  const PipelineResult first = pipeline.run(rendered().left, rendered().right);
  pipeline.run(reference::texture(50, 70, CV_8UC1, 1), reference::texture(50, 70, CV_8UC1, 2));
  const PipelineResult again = pipeline.run(rendered().left, rendered().right);
  EXPECT_EQ(reference::differingPixels(again.disparity, first.disparity), 0);
}

TEST_P(EveryPreset, NeverModifiesTheImages) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const reference::RenderedPair pair = reference::renderPair(60, 90, 4, 9, 2, type);
    const cv::Mat left = pair.left.clone();
    const cv::Mat right = pair.right.clone();
    Pipeline(paramsOf(GetParam())).run(pair.left, pair.right);
    EXPECT_EQ(cv::norm(left, pair.left, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(right, pair.right, cv::NORM_INF), 0.0);
  }
}

TEST_P(EveryPreset, ConfidenceIsBetween0And1AndZeroWithoutAnswer) {
  PipelineParams params = paramsOf(GetParam());
  params.left_right_check.enabled = true;
  const PipelineResult result = Pipeline(params).run(rendered().left, rendered().right);
  int empty = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 200; ++x) {
      const float confidence = result.confidence.at<float>(y, x);
      ASSERT_GE(confidence, 0.0F);
      ASSERT_LE(confidence, 1.0F);
      if (!std::isnan(result.disparity.at<float>(y, x))) continue;
      ++empty;
      ASSERT_EQ(confidence, 0.0F) << x << ", " << y;
    }
  }
  EXPECT_GT(empty, 100);
}

TEST_P(EveryPreset, SurvivesImagesWithoutTexture) {
  for (const int size : {1, 2, 5, 33}) {
    const cv::Mat grey(size, size, CV_8UC1, cv::Scalar(128));
    const PipelineResult result = Pipeline(paramsOf(GetParam())).run(grey, grey);
    EXPECT_EQ(result.disparity.size(), grey.size());
    EXPECT_TRUE(result.matches.empty());
  }
}

TEST_P(EveryPreset, Takes16BitPairsAndNegativeRanges) {
  cv::Mat left;
  cv::Mat right;
  rendered().left.convertTo(left, CV_16U, 16.0);
  rendered().right.convertTo(right, CV_16U, 16.0);
  PipelineParams params = paramsOf(GetParam());
  params.search = {-24, 32};
  const PipelineResult result = Pipeline(params).run(left, right);
  EXPECT_GT(cv::countNonZero(cv::abs(result.disparity - 6.0F) < 0.5F), 120 * 200 / 3);
}

TEST_P(EveryPreset, HotPixelsAndOffsetsOf16BitCostNothing) {
  cv::Mat left;
  cv::Mat right;
  rendered().left.convertTo(left, CV_16U, 4.0, 1.0);
  rendered().right.convertTo(right, CV_16U, 4.0, 1.0);
  const auto right_share = [&](const cv::Mat& a, const cv::Mat& b) {
    return cv::countNonZero(cv::abs(Pipeline(paramsOf(GetParam())).run(a, b).disparity - 6.0F) < 0.5F);
  };
  const int plain = right_share(left, right);
  EXPECT_NEAR(right_share(left + cv::Scalar::all(1000), right + cv::Scalar::all(1000)), plain, 0.01 * plain);
  left.at<cv::Vec3w>(5, 5) = cv::Vec3w::all(65535);
  EXPECT_NEAR(right_share(left, right), plain, 0.01 * plain);
}

TEST(Pipeline, KeepsTheRangeOf16BitUntilAnotherCameraComes) {
  cv::Mat grey;
  cv::cvtColor(rendered().left, grey, cv::COLOR_BGR2GRAY);
  Pipeline pipeline(paramsOf("fast"));
  const auto shown = [&](double factor, const cv::Rect& part) {
    cv::Mat image;
    grey(part).convertTo(image, CV_16U, factor);
    return pipeline.run(image, image).left;
  };
  const cv::Rect all(0, 0, grey.cols, grey.rows), half(0, 0, grey.cols / 2, grey.rows);
  const cv::Mat first = shown(8.0, all);
  EXPECT_LT(cv::mean(shown(7.8, all))[0], cv::mean(first)[0] - 1.0) << "the same range for a darker image";
  EXPECT_TRUE(reference::sameBits(shown(8.0, all), first));
  shown(8.0, half);
  EXPECT_NEAR(cv::mean(shown(7.8, all))[0], cv::mean(first)[0], 1.0) << "a new range after another size";
}

TEST_P(EveryPreset, NamesItsStagesInOrder) {
  const PipelineResult result = Pipeline(paramsOf(GetParam())).run(rendered().left, rendered().right);
  std::vector<std::string> stages;
  for (const StageTime& time : result.times) {
    stages.push_back(time.stage);
    EXPECT_GE(time.ms, 0.0);
  }
  const auto position = [&](const char* name) {
    return std::find(stages.begin(), stages.end(), name) - stages.begin();
  };
  EXPECT_LT(position("feature_matching"), position("row_alignment"));
  EXPECT_LT(position("row_alignment"), position("optimizer"));
  EXPECT_LT(position("optimizer"), static_cast<std::ptrdiff_t>(stages.size()));
}

TEST(Pipeline, MirroredAndSwappedViewsExchangeTheirAnswers) {
  // The mirrored right image against the mirrored left one is a pair too, seen from the other camera.
  PipelineParams params = paramsOf("fast");
  params.row_alignment.enabled = false;
  cv::Mat left;
  cv::Mat right;
  cv::flip(rendered().right, left, 1);
  cv::flip(rendered().left, right, 1);
  const PipelineResult result = Pipeline(params).run(left, right);
  cv::Mat back;
  cv::flip(result.disparity, back, 1);
  // The square is 15 px further left in the right view.
  EXPECT_NEAR(back.at<float>(60, 100 - 15), 15.0F, 0.3F);
  EXPECT_NEAR(back.at<float>(10, 100), 6.0F, 0.3F);
}

TEST_P(EveryPreset, HalfScaleGivesFullSizeAndFullDisparities) {
  PipelineParams params = paramsOf(GetParam());
  params.hole_filling.enabled = true;
  params.scale = 0.5;
  Seeds external = {{100.0F, 10.0F, 6.0F, 1.0F, SeedSource::kPoints}};
  const PipelineResult result = Pipeline(params).run(rendered().left, rendered().right, external);
  ASSERT_EQ(result.disparity.size(), rendered().left.size());
  ASSERT_EQ(result.confidence.size(), rendered().left.size());
  const DisparityErrors errors = evaluateDisparity(result.disparity, rendered().truth, rendered().visible);
  EXPECT_LT(errors.bad[3], 6.0) << "share off by more than 1 px";
  for (const Seed& seed : result.seeds) EXPECT_TRUE(params.search.contains(seed.d)) << seed.d;
  const auto isExternal = [](const Seed& s) { return s.source == SeedSource::kPoints; };
  const auto kept = std::find_if(result.seeds.begin(), result.seeds.end(), isExternal);
  ASSERT_NE(kept, result.seeds.end());
  EXPECT_NEAR(kept->x, 100.0F, 1e-3F);
  EXPECT_NEAR(kept->d, 6.0F, 1e-3F);
}

TEST(Pipeline, ExternalSeedsBecomeSeeds) {
  const Seeds external = {{100.0F, 60.0F, 15.0F, 1.0F, SeedSource::kFile},
                          {20.0F, 20.0F, 500.0F, 1.0F, SeedSource::kFile},
                          {-5.0F, 20.0F, 6.0F, 1.0F, SeedSource::kFile}};
  const PipelineResult result = Pipeline(paramsOf("paper")).run(rendered().left, rendered().right, external);
  int found = 0;
  for (const Seed& seed : result.seeds) {
    if (seed.source == SeedSource::kFile) ++found;
  }
  EXPECT_EQ(found, 1) << "one is beyond the range, one outside the image";
}

TEST(Pipeline, PlanesPresetsFindTheRenderedDisparities) {
  const reference::RenderedPair pair = reference::renderPair(60, 100, 3, 8, 5);
  for (const char* preset : {"paper", "accurate"}) {
    PipelineParams params = loadPreset(preset);
    ASSERT_EQ(params.optimizer, OptimizerType::kLocalExpansion);
    params.search = {0, 12};
    const PipelineResult result = Pipeline(params).run(pair.left, pair.right);
    const DisparityErrors errors = evaluateDisparity(result.disparity, pair.truth, pair.visible);
    EXPECT_GT(errors.density, 99.5) << preset;
    EXPECT_LT(errors.bad[3], 6.0) << preset << ": share off by more than 1 px";
  }
}

/// The share of pixels with an answer.
double answered(const PipelineResult& result) {
  return 1.0 - cv::countNonZero(noneMask(result.disparity)) / static_cast<double>(result.disparity.total());
}

TEST(Pipeline, SaysNothingWhereNothingIsSeen) {
  for (const char* preset : {"fast", "light", "accurate", "paper"}) {
    for (const auto& [left, right] : {std::pair{0, 0}, {128, 128}, {255, 255}, {0, 255}}) {
      PipelineParams params = loadPreset(preset);
      params.search = {5, 16};
      const cv::Size size(100, 60);
      const PipelineResult result = Pipeline(params).run(cv::Mat(size, CV_8UC1, cv::Scalar(left)),
                                                         cv::Mat(size, CV_8UC3, cv::Scalar::all(right)));
      EXPECT_EQ(answered(result), 0.0) << preset << ' ' << left << ' ' << right;
      EXPECT_EQ(cv::countNonZero(result.confidence), 0) << preset;
      EXPECT_TRUE(result.seeds.empty() && result.quasi_dense_seeds.empty()) << preset;
    }
  }
}

TEST(Pipeline, ABlackBorderHoldsNoDisparityAndCostsThePictureNothing) {
  const reference::RenderedPair pair = reference::renderPair(120, 220, 6, 15, 5);
  PipelineParams params = loadPreset("fast");
  params.search = {0, 32};
  const cv::Rect inside(18, 12, 180, 96);
  cv::Mat views[2] = {cv::Mat::zeros(pair.left.size(), pair.left.type()),
                      cv::Mat::zeros(pair.left.size(), pair.left.type())};
  pair.left(inside).copyTo(views[0](inside));
  pair.right(inside).copyTo(views[1](inside));
  const PipelineResult result = Pipeline(params).run(views[0], views[1]);
  cv::Mat border(pair.left.size(), CV_8UC1, cv::Scalar(255));
  border(inside).setTo(0);
  EXPECT_EQ(cv::countNonZero(border & ~noneMask(result.disparity)), 0);
  const cv::Rect seen(inside.x + 18, inside.y + 3, inside.width - 24, inside.height - 6);
  const PipelineResult whole = Pipeline(params).run(pair.left, pair.right);
  const auto bad = [&](const PipelineResult& of) {
    return evaluateDisparity(of.disparity(seen).clone(), pair.truth(seen).clone(), pair.visible(seen).clone()).bad[3];
  };
  EXPECT_LE(bad(result), bad(whole) + 0.5);
}

TEST(Pipeline, FilledPixelsHaveNoConfidence) {
  const reference::RenderedPair pair = reference::renderPair(120, 200, 6, 15, 5);
  PipelineParams params = loadPreset("fast");
  params.search = {0, 32};
  const PipelineResult open = Pipeline(params).run(pair.left, pair.right);
  params.hole_filling.enabled = true;
  const PipelineResult filled = Pipeline(params).run(pair.left, pair.right);
  EXPECT_EQ(answered(filled), 1.0);
  const cv::Mat holes = noneMask(open.disparity);
  ASSERT_GT(cv::countNonZero(holes), 0);
  EXPECT_EQ(cv::countNonZero((filled.confidence > 0.0F) & holes), 0);
  EXPECT_TRUE(reference::sameBits(filled.confidence, open.confidence));
}

TEST(Pipeline, LargePenaltiesDoNotCoarsenTheCosts) {
  PipelineParams params = paramsOf("fast");
  params.semi_global.p1 = 4.0;
  params.semi_global.p2 = 20.0;
  const PipelineResult result = Pipeline(params).run(rendered().left, rendered().right);
  EXPECT_LT(evaluateDisparity(result.disparity, rendered().truth, rendered().visible).bad[4], 25.0);
  EXPECT_EQ(fitCostScale(1.7, 3.6).depth, CostVolume::Depth::kU8);
  EXPECT_EQ(fitCostScale(1.7, 64.0).depth, CostVolume::Depth::kU16);
  for (const double penalties : {0.0, 3.6, 20.0, 200.0}) {
    EXPECT_GE(1.7 / fitCostScale(1.7, penalties).step, 48.0) << "levels of the cost";
  }
}

TEST(Pipeline, CanBeMoved) {
  Pipeline first(paramsOf("fast"));
  const cv::Mat expected = first.run(rendered().left, rendered().right).disparity;
  Pipeline second = std::move(first);
  EXPECT_TRUE(reference::sameBits(second.run(rendered().left, rendered().right).disparity, expected));
}

TEST(Pipeline, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Pipeline(paramsOf("fast")).run(cv::Mat(), cv::Mat()), std::invalid_argument);
  EXPECT_THROW(Pipeline(paramsOf("fast")).run(rendered().left, rendered().right.colRange(0, 100)),
               std::invalid_argument);
  PipelineParams params = paramsOf("fast");
  params.search.count = 0;
  EXPECT_THROW(Pipeline{params}, std::invalid_argument);
  params = paramsOf("fast");
  params.max_memory_mb = 16.0;
  params.search.count = 1024;
  EXPECT_THROW(Pipeline(params).run(rendered().left, rendered().right), std::invalid_argument);
}

TEST(Pipeline, NewParametersTakeEffectAndBadOnesChangeNothing) {
  Pipeline pipeline(paramsOf("fast"));
  const PipelineResult before = pipeline.run(rendered().left, rendered().right);
  PipelineParams params = paramsOf("fast");
  params.search.count = 8;
  pipeline.setParams(params);
  const PipelineResult after = pipeline.run(rendered().left, rendered().right);
  double largest = 0.0;
  cv::minMaxLoc(after.disparity, nullptr, &largest, nullptr, nullptr, after.disparity == after.disparity);
  EXPECT_LT(largest, 8.0);
  params.search.count = -1;
  EXPECT_THROW(pipeline.setParams(params), std::invalid_argument);
  EXPECT_EQ(pipeline.params().search.count, 8);
}

/// Bounds recorded from the first measurement, about a tenth above it: what must not get worse unnoticed.
TEST(Pipeline, RealPairsStayWithinTheirRecordedBounds) {
  const std::string folder = FDP_STEREO_SOURCE_DIR "/../shared/data/MiddEval3-trainingQ/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const std::pair<const char*, double> bounds[] = {{"Teddy", 7.0}, {"Motorcycle", 7.0}, {"Recycle", 9.5}};
  for (const auto& [name, bad_1] : bounds) {
    const Scene scene = readScene(findScenes(folder + name).front());
    PipelineParams params = loadPreset("fast");
    params.search = {0, scene.num_disparities};
    params.hole_filling.enabled = true;
    const PipelineResult result = Pipeline(params).run(scene.left, scene.right);
    EXPECT_LT(evaluateDisparity(result.disparity, scene.truth, scene.mask).bad[3], bad_1) << name;
  }
}

}  // namespace
}  // namespace fdp_stereo
