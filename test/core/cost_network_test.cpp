// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "costs/cost_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fdp_stereo/matching_cost.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

/// The definition, in floating point: what is computed for (x, y), which is farther than kReach from the border.
std::vector<double> referenceDescriptor(const NetworkWeights& weights, const cv::Mat& grey, int x, int y) {
  const int sides[] = {5, 3, 3};
  std::vector<cv::Mat> maps;
  cv::Mat input;
  grey(cv::Rect(x - 4, y - 4, 9, 9)).convertTo(input, CV_64F, 1.0 / 32.0);
  maps.push_back(input);
  const std::int32_t* next = weights.numbers.data();
  for (int layer = 0; layer < 3; ++layer) {
    const double unit = layer == 0 ? std::pow(2.0, 17) / 32.0 : 4096.0;
    const double bias_unit = layer == 0 ? std::pow(2.0, 17) : std::pow(2.0, 22);
    const int size = maps[0].rows - sides[layer] + 1;
    std::vector<cv::Mat> outputs;
    for (int o = 0; o < weights.channels[layer]; ++o) {
      const int count = sides[layer] * sides[layer] * static_cast<int>(maps.size());
      cv::Mat output(size, size, CV_64F, cv::Scalar(next[count] / bias_unit));
      for (int i = 0; i < count; ++i) {
        const int tap = i / static_cast<int>(maps.size());
        const cv::Mat& map = maps[i % static_cast<int>(maps.size())];
        output += map(cv::Rect(tap % sides[layer], tap / sides[layer], size, size)) * (next[i] / unit);
      }
      next += count + 1;
      if (layer < 2) {
        output = cv::min(cv::max(output, -1.0), 1.0);
        output = output.mul(3.0 - output.mul(output)) / 2.0;
      }
      outputs.push_back(output);
    }
    maps = outputs;
  }
  double square = std::pow(weights.floor / 65536.0, 2);
  for (const cv::Mat& map : maps) square += map.dot(map);
  std::vector<double> descriptor;
  for (const cv::Mat& map : maps) descriptor.push_back(map.at<double>(0, 0) / std::sqrt(square) * CostNetwork::kUnit);
  return descriptor;
}

cv::Mat describe(const cv::Mat& grey) {
  cv::Mat descriptors;
  CostNetwork::builtIn().describe(grey, descriptors);
  return descriptors;
}

TEST(CostNetwork, EqualsItsDefinition) {
  const cv::Mat grey = reference::texture(40, 33, CV_8UC1, 3);
  const cv::Mat descriptors = describe(grey);
  const int length = CostNetwork::builtIn().length();
  ASSERT_EQ(descriptors.cols, 33 * length);
  for (const int y : {4, 15, 16, 35}) {
    for (const int x : {4, 17, 28}) {
      const std::vector<double> expected = referenceDescriptor(costNetworkWeights(), grey, x, y);
      for (int c = 0; c < length; ++c) EXPECT_NEAR(descriptors.at<std::int8_t>(y, x * length + c), expected[c], 1.5);
    }
  }
}

using CostNetworkKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(CostNetworkKernel);

TEST_P(CostNetworkKernel, DescribesWithTheSameBits) {
  for (const auto& [rows, cols] : {std::pair{1, 1}, {3, 5}, {17, 30}, {50, 61}}) {
    const cv::Mat grey = reference::noise(rows, cols, CV_8UC1, 5);
    const auto bits = [&] { return describe(grey); };
    EXPECT_EQ(cv::norm(onThisSet(bits), onBaseline(bits), cv::NORM_INF), 0.0) << rows << " x " << cols;
  }
}

NetworkWeights randomWeights(std::array<int, 3> channels) {
  NetworkWeights weights{channels, 60000, {}};
  cv::RNG random(7);
  const int inputs[] = {25, 9 * channels[0], 9 * channels[1]};
  for (int layer = 0; layer < 3; ++layer) {
    for (int i = 0; i < channels[layer] * (inputs[layer] + 1); ++i)
      weights.numbers.push_back(random.uniform(-999, 999));
  }
  return weights;
}

TEST_P(CostNetworkKernel, TakesEveryNumberOfChannels) {
  const cv::Mat grey = reference::noise(20, 31, CV_8UC1, 6);
  for (const auto& channels : {std::array{8, 16, 24}, {16, 24, 32}, {32, 8, 8}}) {
    const CostNetwork network(randomWeights(channels));
    const auto bits = [&] {
      cv::Mat descriptors;
      network.describe(grey, descriptors);
      return descriptors;
    };
    EXPECT_EQ(cv::norm(onThisSet(bits), onBaseline(bits), cv::NORM_INF), 0.0);
  }
}

TEST(CostNetwork, RefusesWeightsThatCannotBe) {
  const NetworkWeights good = randomWeights({16, 16, 24});
  EXPECT_NO_THROW(CostNetwork{good});
  NetworkWeights bad = good;
  bad.numbers.pop_back();
  EXPECT_THROW(CostNetwork{bad}, std::invalid_argument);
  bad = good;
  bad.channels[1] = 1 << 30;
  EXPECT_THROW(CostNetwork{bad}, std::invalid_argument);
  bad = good;
  bad.numbers[3] = 40000;
  EXPECT_THROW(CostNetwork{bad}, std::invalid_argument) << "16 bits";
  bad = good;
  std::fill(bad.numbers.begin(), bad.numbers.end(), 32767);
  EXPECT_THROW(CostNetwork{bad}, std::invalid_argument) << "sums of 32 bits";
}

TEST(CostNetwork, BarelySeesOtherLight) {
  const cv::Mat grey = reference::texture(30, 50, CV_8UC1, 4);
  EXPECT_LE(cv::norm(describe(grey / 2), describe(grey / 2 + 60), cv::NORM_INF), 0.0) << "an offset";
}

MatchingCostParams learnedAlone() {
  MatchingCostParams params;
  params.type = MatchingCostType::kLearned;
  params.learned_weight = 1.0;
  return params;
}

TEST(LearnedCost, IsThatOfTheDescriptors) {
  const StereoPair pair = prepareImages(reference::texture(9, 60, CV_8UC1, 1), reference::texture(9, 60, CV_8UC1, 2));
  const cv::Mat left = describe(pair.left), right = describe(pair.right);
  const int length = CostNetwork::builtIn().length();
  const MatchingCostParams params = learnedAlone();
  for (const auto depth : {CostVolume::Depth::kU8, CostVolume::Depth::kU16}) {
    CostVolume volume;
    computeMatchingCost(pair, {-3, 20}, params, {depth, 0.01F}, volume);
    for (int x = 20; x < 50; ++x) {
      for (int i = 0; i < 20; ++i) {
        const cv::Rect from(x * length, 4, length, 1), to((x + 3 - i) * length, 4, length, 1);
        const double like = (1.0 + left(from).dot(right(to)) / (127.0 * 127.0)) / 2.0;
        ASSERT_NEAR(volume.cost(4, x, i), maxMatchingCost(params) * (1.0 - std::pow(like, 4)), 0.015) << x << ", " << i;
      }
    }
  }
}

TEST(LearnedCost, FindsARenderedPlane) {
  const reference::RenderedPair pair = reference::renderPair(120, 180, 6, 11, 3);
  PipelineParams params;
  params.matching_cost.type = MatchingCostType::kLearned;
  params.search = {0, 24};
  for (const double weight : {0.5, 1.0}) {
    params.matching_cost.learned_weight = weight;
    const PipelineResult result = Pipeline(params).run(pair.left, pair.right);
    const cv::Mat wrong = (cv::abs(result.disparity - pair.truth) > 1.0) & pair.visible;
    EXPECT_LT(cv::countNonZero(wrong), 0.03 * cv::countNonZero(pair.visible)) << weight;
  }
}

}  // namespace
}  // namespace fdp_stereo
