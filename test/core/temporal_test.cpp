// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/temporal.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "images/temporal_average.hpp"
#include "reference/post_processing_reference.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

constexpr double kNoise = 3.0;

const reference::RenderedPair& scene() {
  static const reference::RenderedPair pair = reference::renderPair(120, 200, 6, 15, 5);
  return pair;
}

cv::Mat noisy(const cv::Mat& image, int seed, double gain = 1.0) {
  cv::Mat noise(image.size(), CV_MAKETYPE(CV_32F, image.channels())), sum;
  cv::RNG(static_cast<std::uint64_t>(seed) + 1).fill(noise, cv::RNG::NORMAL, 0.0, kNoise * gain);
  image.convertTo(sum, CV_32F, gain);
  sum += noise;
  sum.convertTo(sum, image.depth());
  return sum;
}

/// The pair `frame` of a stream; a rectangle of it moves where one is wanted.
StereoPair pairOf(int frame, int moved_px = 0) {
  const auto view = [&](const cv::Mat& image, int seed) {
    cv::Mat moved = image.clone();
    if (moved_px > 0) image(cv::Rect(20, 30, 60, 50)).copyTo(moved(cv::Rect(20 + moved_px, 30, 60, 50)));
    return noisy(moved, seed);
  };
  return prepareImages(view(scene().left, 2 * frame), view(scene().right, 2 * frame + 1));
}

double errorOf(const cv::Mat& image, const cv::Mat& truth) { return cv::norm(image, truth, cv::NORM_L1); }

TEST(Temporal, TheFirstPairIsAsItWasGiven) {
  TemporalAverage average;
  StereoPair pair = pairOf(0);
  const TemporalAverage::Outcome outcome = average.update(pair);
  EXPECT_EQ(outcome.reset, "first pair");
  EXPECT_EQ(outcome.kept_share, 0.0);
  EXPECT_EQ(cv::norm(pair.left, pairOf(0).left, cv::NORM_INF), 0.0);
}

TEST(Temporal, NoiseGoesWhereNothingMoves) {
  TemporalAverage average;
  StereoPair pair;
  TemporalAverage::Outcome outcome;
  for (int i = 0; i < 12; ++i) outcome = average.update(pair = pairOf(i));
  EXPECT_GT(outcome.kept_share, 0.99);
  EXPECT_EQ(outcome.reset, "");
  EXPECT_LT(errorOf(pair.left, scene().left), 0.4 * errorOf(pairOf(11).left, scene().left));
  EXPECT_LT(errorOf(pair.right, scene().right), 0.4 * errorOf(pairOf(11).right, scene().right));
}

TEST(Temporal, BetweenItsStepsAStillViewIsTheSameToTheBit) {
  TemporalAverage average;
  int same = 0;
  for (int i = 0; i < 64; ++i) {
    StereoPair pair = pairOf(i);
    same += average.update(pair).changed ? 0 : 1;
  }
  EXPECT_GE(same, 40);
}

TEST(Temporal, WhatMovesIsShownAsItIsNow) {
  TemporalAverage average;
  for (int i = 0; i < 9; ++i) {
    StereoPair pair = pairOf(i);
    average.update(pair);
  }
  StereoPair pair = pairOf(9, 30);
  const TemporalAverage::Outcome outcome = average.update(pair);
  EXPECT_EQ(outcome.reset, "");
  EXPECT_GT(outcome.kept_share, 0.7);
  const cv::Rect moved(50, 30, 60, 50), still(130, 10, 60, 100);
  EXPECT_EQ(cv::norm(pair.left(moved), pairOf(9, 30).left(moved), cv::NORM_INF), 0.0);
  EXPECT_LT(errorOf(pair.left(still), scene().left(still)), 0.6 * errorOf(pairOf(9).left(still), scene().left(still)));
}

TEST(Temporal, ACameraThatMovesHasNoMemory) {
  TemporalAverage average;
  for (int i = 0; i < 6; ++i) {
    const cv::Rect seen(3 * i, i, 160, 100);
    const StereoPair given = prepareImages(noisy(scene().left(seen), 2 * i), noisy(scene().right(seen), 2 * i + 1));
    StereoPair pair = given;
    const TemporalAverage::Outcome outcome = average.update(pair);
    EXPECT_EQ(outcome.reset, i == 0 ? "first pair" : "the view changed");
    EXPECT_EQ(cv::norm(pair.left, given.left, cv::NORM_INF), 0.0) << i;
    EXPECT_EQ(cv::norm(pair.right, given.right, cv::NORM_INF), 0.0) << i;
  }
}

TEST(Temporal, MeansFollowLightThatChangesEverywhere) {
  TemporalAverage average;
  for (int i = 0; i < 12; ++i) {
    const double light = 0.8 + 0.05 * (i % 3);
    const StereoPair given = prepareImages(noisy(scene().left, 2 * i, light), noisy(scene().right, 2 * i + 1, light));
    StereoPair pair = given;
    const TemporalAverage::Outcome outcome = average.update(pair);
    EXPECT_EQ(outcome.reset, i == 0 ? "first pair" : "");
    if (i < 6) continue;
    EXPECT_GT(outcome.kept_share, 0.9);
    const cv::Mat truth = light * scene().left;
    EXPECT_LT(errorOf(pair.left, truth), 0.6 * errorOf(given.left, truth));
  }
}

TEST(Temporal, LightThatBlowsOutDoesNotWrapAround) {
  TemporalAverage average;
  for (int i = 0; i < 6; ++i) {
    const StereoPair given = prepareImages(scene().left * (1.0 + 0.1 * i), scene().right * (1.0 + 0.1 * i));
    StereoPair pair = given;
    average.update(pair);
    EXPECT_LT(cv::norm(pair.left_grey, given.left_grey, cv::NORM_INF), 16.0) << i;
  }
}

TEST(Temporal, ACutEndsTheMemory) {
  TemporalAverage average;
  for (int i = 0; i < 4; ++i) {
    StereoPair pair = pairOf(i);
    average.update(pair);
  }
  const reference::RenderedPair other = reference::renderPair(120, 200, 6, 15, 77);
  const StereoPair given = prepareImages(other.left, other.right);
  StereoPair pair = given;
  EXPECT_EQ(average.update(pair).reset, "the view changed");
  EXPECT_EQ(cv::norm(pair.left, given.left, cv::NORM_INF), 0.0);
}

TEST(Temporal, NoiseThatGrowsWithTheLightIsNoise) {
  cv::Mat grey(120, 200, CV_8UC1);
  for (int x = 0; x < grey.cols; ++x) grey.col(x).setTo(20 + x);
  const auto view = [&](int seed) {
    cv::Mat noise(grey.size(), CV_32F), deviation, sum;
    cv::RNG(static_cast<std::uint64_t>(seed) + 1).fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
    grey.convertTo(sum, CV_32F);
    cv::sqrt(sum * 0.1, deviation);
    sum += noise.mul(deviation);
    sum.convertTo(sum, CV_8U);
    return sum;
  };
  TemporalAverage average;
  TemporalAverage::Outcome outcome;
  for (int i = 0; i < 8; ++i) {
    StereoPair pair = prepareImages(view(2 * i), view(2 * i + 1));
    outcome = average.update(pair);
  }
  EXPECT_GT(outcome.kept_share, 0.99);
}

TEST(Temporal, OtherSizesAndTypesBeginAnew) {
  TemporalAverage average;
  cv::Mat grey_left, grey_right;
  cv::cvtColor(scene().left, grey_left, cv::COLOR_BGR2GRAY);
  cv::cvtColor(scene().right, grey_right, cv::COLOR_BGR2GRAY);
  cv::Mat deep_left, deep_right;
  grey_left.convertTo(deep_left, CV_16U, 16.0);
  grey_right.convertTo(deep_right, CV_16U, 16.0);
  const std::vector<std::pair<cv::Mat, cv::Mat>> kinds = {{scene().left, scene().right},
                                                          {grey_left, grey_right},
                                                          {deep_left, deep_right},
                                                          {grey_left.colRange(0, 90), grey_right.colRange(0, 90)},
                                                          {grey_left.rowRange(0, 5), grey_right.rowRange(0, 5)}};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    StereoPair pair = prepareImages(kinds[i].first, kinds[i].second);
    EXPECT_EQ(average.update(pair).reset, i == 0 ? "first pair" : "images of another size or type");
    pair = prepareImages(kinds[i].first, kinds[i].second);
    const TemporalAverage::Outcome outcome = average.update(pair);
    EXPECT_EQ(outcome.reset, "");
    EXPECT_FALSE(outcome.changed);
    EXPECT_EQ(outcome.kept_share, 1.0);
    EXPECT_EQ(cv::norm(pair.left_grey, prepareImages(kinds[i].first, kinds[i].second).left_grey, cv::NORM_INF), 0.0);
  }
}

TEST(Temporal, DisparitiesOfOneSurfaceMeetHalfWayAndOthersAreThoseOfNow) {
  TemporalAverage average;
  cv::Mat before(120, 200, CV_32FC1, cv::Scalar(8.0)), now(120, 200, CV_32FC1, cv::Scalar(8.5));
  now.at<float>(60, 100) = 12.0F;
  now.at<float>(60, 101) = kInvalidDisparity;
  StereoPair pair = pairOf(0);
  average.update(pair);
  cv::Mat first = now.clone();
  average.steady(before, first);
  EXPECT_TRUE(reference::sameBits(first, now)) << "of the first pair there is no memory";
  pair = pairOf(1);
  average.update(pair);
  average.steady(before, now);
  EXPECT_EQ(now.at<float>(50, 100), 8.25F);
  EXPECT_EQ(now.at<float>(60, 100), 12.0F);
  EXPECT_TRUE(std::isnan(now.at<float>(60, 101)));
  EXPECT_EQ(now.at<float>(50, 3), 8.5F) << "its match is beside the right image";
}

PipelineParams paramsOf(int threads = 1) {
  PipelineParams params = loadPreset("fast");
  params.search = {0, 32};
  params.threads = threads;
  return params;
}

PipelineResult run(Pipeline& pipeline, int frame) {
  return pipeline.run(noisy(scene().left, 2 * frame), noisy(scene().right, 2 * frame + 1));
}

TEST(TemporalPipeline, EveryPairAfterAResetIsTheSingleFrame) {
  Pipeline stream(paramsOf());
  stream.setStream(true);
  PipelineParams other = paramsOf();
  other.semi_global.p1 = 0.5;
  const std::vector<std::pair<std::string, std::function<void(int)>>> resets = {
      {"first pair", [](int) {}},
      {"stamps jumped back", [&](int) { stream.reset("stamps jumped back"); }},
      {"new parameters", [&](int) { stream.setParams(other); }}};
  int frame = 0;
  for (const auto& [reason, reset] : resets) {
    reset(frame);
    const PipelineResult result = run(stream, frame);
    EXPECT_EQ(result.temporal.reset, reason);
    Pipeline single(stream.params());
    const PipelineResult expected = run(single, frame);
    EXPECT_TRUE(reference::sameBits(result.disparity, expected.disparity)) << reason;
    EXPECT_TRUE(reference::sameBits(result.confidence, expected.confidence)) << reason;
    for (int i = 0; i < 3; ++i) EXPECT_EQ(run(stream, ++frame).temporal.reset, "");
    ++frame;
  }
}

TEST(TemporalPipeline, PairsByThemselvesHaveNoMemory) {
  Pipeline pipeline(paramsOf()), off(paramsOf());
  PipelineParams params = paramsOf();
  params.temporal.enabled = false;
  off.setParams(params);
  off.setStream(true);
  run(pipeline, 0);
  run(off, 0);
  Pipeline single(paramsOf());
  const cv::Mat expected = run(single, 1).disparity;
  EXPECT_TRUE(reference::sameBits(run(pipeline, 1).disparity, expected));
  EXPECT_TRUE(reference::sameBits(run(off, 1).disparity, expected));
}

TEST(TemporalPipeline, AStreamHasTheSameBitsForAnyNumberOfThreads) {
  Pipeline one(paramsOf(1)), three(paramsOf(3));
  one.setStream(true);
  three.setStream(true);
  int repeated = 0;
  for (int i = 0; i < 10; ++i) {
    const PipelineResult expected = run(one, i), result = run(three, i);
    EXPECT_TRUE(reference::sameBits(result.disparity, expected.disparity)) << i;
    EXPECT_EQ(result.temporal.repeated, expected.temporal.repeated);
    repeated += result.temporal.repeated ? 1 : 0;
  }
  EXPECT_GE(repeated, 3);
}

TEST(TemporalPipeline, AnotherScaleKeepsTheImagesAndForgetsTheDisparity) {
  Pipeline stream(paramsOf()), single(paramsOf());
  stream.setStream(true);
  stream.run(scene().left, scene().right);
  const cv::Mat expected = single.run(scene().left, scene().right).disparity;
  for (const double scale : {0.5, 1.0}) {
    stream.setScale(scale);
    const PipelineResult result = stream.run(scene().left, scene().right);
    EXPECT_EQ(result.temporal.reset, "");
    EXPECT_FALSE(result.temporal.repeated);
    EXPECT_EQ(reference::sameBits(result.disparity, expected), scale == 1.0);
  }
  EXPECT_GT(stream.run(scene().left, scene().right).temporal.kept_share, 0.9);
  EXPECT_THROW(stream.setScale(0.0), std::invalid_argument);
  EXPECT_EQ(stream.params().scale, 1.0);
}

TEST(TemporalPipeline, ARepeatedResultIsTheCallersOwn) {
  Pipeline pipeline(paramsOf());
  pipeline.setStream(true);
  const PipelineResult first = pipeline.run(scene().left, scene().right);
  const cv::Mat expected = first.disparity.clone();
  PipelineResult second = pipeline.run(scene().left, scene().right);
  ASSERT_TRUE(second.temporal.repeated);
  second.disparity.setTo(0.0F);
  const PipelineResult third = pipeline.run(scene().left, scene().right);
  EXPECT_TRUE(reference::sameBits(third.disparity, expected));
  EXPECT_FALSE(third.times.empty());
}

TEST(TemporalPipeline, WhatANewListenerWantsIsComputed) {
  Pipeline pipeline(paramsOf());
  pipeline.setStream(true);
  pipeline.setQuality(Pipeline::Quality::kNone);
  for (int i = 0; i < 9; ++i) run(pipeline, i);
  const PipelineResult first = run(pipeline, 9);
  ASSERT_TRUE(first.temporal.repeated);
  pipeline.setQuality(Pipeline::Quality::kEstimated);
  const PipelineResult result = run(pipeline, 10);
  EXPECT_FALSE(result.confidence.empty());
  EXPECT_TRUE(reference::sameBits(result.disparity, first.disparity)) << "who listens must not change the disparity";
}

TEST(TemporalPipeline, SeedsOfOtherSensorsAreAlwaysUsed) {
  Pipeline pipeline(paramsOf());
  pipeline.setStream(true);
  pipeline.run(scene().left, scene().right);
  Seed seed;
  seed.x = 100.0F;
  seed.y = 60.0F;
  seed.d = scene().truth.at<float>(60, 100);
  seed.source = SeedSource::kPoints;
  EXPECT_FALSE(pipeline.run(scene().left, scene().right, {seed}).temporal.repeated);
  EXPECT_FALSE(pipeline.run(scene().left, scene().right).temporal.repeated) << "the result before was of other seeds";
  EXPECT_TRUE(pipeline.run(scene().left, scene().right).temporal.repeated);
}

}  // namespace
}  // namespace fdp_stereo
