// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "reference/evaluation_reference.hpp"

namespace fdp_stereo {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(Evaluation, HandWorkedCase) {
  // Errors of the scored pixels: 0, 0.2, 0.5 (not above 0.5), 3, 900 (capped at 100), no answer, no answer (negative).
  const cv::Mat truth = (cv::Mat_<float>(1, 9) << 5.0F, 5.0F, 5.0F, 5.0F, 5.0F, 5.0F, 5.0F, kNone, 5.0F);
  const cv::Mat disparity = (cv::Mat_<float>(1, 9) << 5.0F, 5.2F, 5.5F, 2.0F, 905.0F, kNone, -1.0F, 1.0F, 77.0F);
  const cv::Mat mask = (cv::Mat_<std::uint8_t>(1, 9) << 255, 255, 255, 255, 255, 255, 255, 255, 128);
  const DisparityErrors errors = evaluateDisparity(disparity, truth, mask);
  EXPECT_DOUBLE_EQ(errors.bad[0], 100.0 * 6 / 7);
  EXPECT_DOUBLE_EQ(errors.bad[1], 100.0 * 5 / 7);
  EXPECT_DOUBLE_EQ(errors.bad[2], 100.0 * 4 / 7);
  EXPECT_DOUBLE_EQ(errors.bad[4], 100.0 * 4 / 7);
  EXPECT_DOUBLE_EQ(errors.bad[5], 100.0 * 3 / 7);
  EXPECT_DOUBLE_EQ(errors.d1, 100.0 * 3 / 7);
  EXPECT_DOUBLE_EQ(errors.density, 100.0 * 5 / 7);
  EXPECT_DOUBLE_EQ(errors.sparse_bad_half, 100.0 * 2 / 5);
  EXPECT_NEAR(errors.average_px, (0.0 + 0.2 + 0.5 + 3.0 + 100.0) / 5, 1e-6);
  EXPECT_DOUBLE_EQ(errors.a95_px, 100.0);
}

TEST(Evaluation, EqualsThePlainReference) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(-2.0F, 20.0F);
  for (int trial = 0; trial < 20; ++trial) {
    const int rows = 3 + trial;
    const int cols = 37 - trial;
    cv::Mat truth(rows, cols, CV_32FC1);
    cv::Mat disparity(rows, cols, CV_32FC1);
    cv::Mat mask(rows, cols, CV_8UC1);
    for (int i = 0; i < rows * cols; ++i) {
      truth.at<float>(i / cols, i % cols) = random() % 4 == 0 ? kNone : std::abs(value(random));
      disparity.at<float>(i / cols, i % cols) = random() % 6 == 0 ? kNone : value(random);
      mask.at<std::uint8_t>(i / cols, i % cols) = random() % 3 == 0 ? 128 : 255;
    }
    for (const cv::Mat& region : {mask, cv::Mat()}) {
      const DisparityErrors fast = evaluateDisparity(disparity, truth, region);
      const DisparityErrors slow = reference::evaluateDisparity(disparity, truth, region);
      for (std::size_t t = 0; t < fast.bad.size(); ++t) EXPECT_NEAR(fast.bad[t], slow.bad[t], 1e-9);
      EXPECT_NEAR(fast.d1, slow.d1, 1e-9);
      EXPECT_NEAR(fast.density, slow.density, 1e-9);
      EXPECT_NEAR(fast.sparse_bad_half, slow.sparse_bad_half, 1e-9);
      EXPECT_NEAR(fast.average_px, slow.average_px, 1e-9);
      EXPECT_DOUBLE_EQ(fast.a95_px, slow.a95_px);
    }
  }
}

TEST(Evaluation, D1ForgivesFivePercentOfLargeDisparities) {
  const cv::Mat truth = (cv::Mat_<float>(1, 4) << 100.0F, 100.0F, 10.0F, 10.0F);
  const DisparityErrors errors =
      evaluateDisparity((cv::Mat_<float>(1, 4) << 104.0F, 106.0F, 14.0F, 12.0F), truth, cv::Mat());
  EXPECT_DOUBLE_EQ(errors.bad[5], 75.0);
  EXPECT_DOUBLE_EQ(errors.d1, 50.0);
}

TEST(Evaluation, A95LeavesOutFivePercentOfTheAnswers) {
  cv::Mat disparity(1, 40, CV_32FC1);
  for (int x = 0; x < 40; ++x) disparity.at<float>(0, x) = static_cast<float>(40 - x);  // errors 40 down to 1
  const cv::Mat truth(1, 40, CV_32FC1, cv::Scalar(0.0));
  EXPECT_DOUBLE_EQ(evaluateDisparity(disparity, truth, cv::Mat()).a95_px, 38.0);
  disparity.colRange(0, 20) = kNone;
  EXPECT_DOUBLE_EQ(evaluateDisparity(disparity, truth, cv::Mat()).a95_px, 19.0);
  EXPECT_DOUBLE_EQ(evaluateDisparity(disparity.colRange(39, 40), truth.colRange(39, 40), cv::Mat()).a95_px, 1.0);
}

TEST(Evaluation, InfinityIsNoAnswerAndNoTruth) {
  const float infinity = std::numeric_limits<float>::infinity();
  const cv::Mat truth = (cv::Mat_<float>(1, 2) << 4.0F, infinity);
  const DisparityErrors errors = evaluateDisparity((cv::Mat_<float>(1, 2) << infinity, 4.0F), truth, cv::Mat());
  EXPECT_DOUBLE_EQ(errors.bad[4], 100.0);
  EXPECT_DOUBLE_EQ(errors.density, 0.0);
  EXPECT_DOUBLE_EQ(errors.sparse_bad_half, 100.0);
  EXPECT_DOUBLE_EQ(errors.average_px, 100.0);
  EXPECT_DOUBLE_EQ(errors.a95_px, 100.0);
}

TEST(Evaluation, RefusesWhatItCannotCompare) {
  const cv::Mat map(3, 4, CV_32FC1, cv::Scalar(1.0));
  EXPECT_THROW(evaluateDisparity(map, cv::Mat(4, 3, CV_32FC1, cv::Scalar(1.0)), cv::Mat()), std::invalid_argument);
  EXPECT_THROW(evaluateDisparity(map, map, cv::Mat(4, 4, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(evaluateDisparity(cv::Mat(3, 4, CV_8UC1), map, cv::Mat()), std::invalid_argument);
  EXPECT_THROW(evaluateDisparity(map, cv::Mat(3, 4, CV_32FC1, cv::Scalar(kNone)), cv::Mat()), std::invalid_argument);
  EXPECT_THROW(evaluateDisparity(map, map, cv::Mat(3, 4, CV_8UC1, cv::Scalar(128))), std::invalid_argument);
  EXPECT_THROW(evaluateDisparity(cv::Mat(), cv::Mat(), cv::Mat()), std::invalid_argument);
}

TEST(Average, WeighsTheScenes) {
  DisparityErrors first;
  first.bad[0] = 10.0;
  first.average_px = 1.0;
  first.a95_px = 2.0;
  DisparityErrors second;
  second.bad[0] = 40.0;
  second.average_px = 4.0;
  second.a95_px = 5.0;
  const DisparityErrors mean = averageErrors({first, second}, {1.0, 0.5});
  EXPECT_DOUBLE_EQ(mean.bad[0], 20.0);
  EXPECT_DOUBLE_EQ(mean.average_px, 2.0);
  EXPECT_DOUBLE_EQ(mean.a95_px, 3.0);
  EXPECT_THROW(averageErrors({}, {}), std::invalid_argument);
  EXPECT_THROW(averageErrors({first}, {0.0}), std::invalid_argument);
  EXPECT_THROW(averageErrors({first}, {1.0, 1.0}), std::invalid_argument);
}

TEST(Average, MiddleburyHalvesFiveScenes) {
  EXPECT_DOUBLE_EQ(middleburyWeight("Playtable"), 0.5);
  EXPECT_DOUBLE_EQ(middleburyWeight("Piano"), 1.0);
  EXPECT_DOUBLE_EQ(middleburyWeight("PianoL"), 0.5);
  EXPECT_DOUBLE_EQ(middleburyWeight("PianoL+noise"), 0.5);
}

TEST(ErrorColors, TellErrorsApart) {
  const cv::Mat truth = (cv::Mat_<float>(1, 5) << 5.0F, 5.0F, 5.0F, kNone, 5.0F);
  const cv::Mat disparity = (cv::Mat_<float>(1, 5) << 5.0F, 15.0F, kNone, 5.0F, 5.0F);
  const cv::Mat mask = (cv::Mat_<std::uint8_t>(1, 5) << 255, 255, 255, 255, 128);
  const cv::Mat colors = colorizeErrors(disparity, truth, mask);
  const auto at = [&](int x) { return colors.at<cv::Vec3b>(0, x); };
  EXPECT_GT(at(0)[0], at(0)[2]);
  EXPECT_GT(at(1)[2], at(1)[0]);
  EXPECT_EQ(at(2), cv::Vec3b(255, 0, 255));
  EXPECT_EQ(at(3), cv::Vec3b(0, 0, 0));
  EXPECT_LT(at(4)[0], at(0)[0]);
}

TEST(SimulateSeeds, ShareNoiseAndOutliersAreAsAsked) {
  cv::Mat truth(400, 500, CV_32FC1, cv::Scalar(20.0F));
  truth.rowRange(0, 100) = std::numeric_limits<float>::quiet_NaN();
  SeedSimulation simulation;
  simulation.share = 0.05;
  simulation.outliers = 0.1;
  const Seeds seeds = simulateSeeds(truth, {0, 64}, simulation);
  EXPECT_NEAR(static_cast<double>(seeds.size()), 0.05 * 300 * 500, 300.0);
  int far_off = 0;
  double squares = 0.0;
  for (const Seed& seed : seeds) {
    EXPECT_GE(seed.y, 100.0F);
    const double error = seed.d - 20.0;
    if (std::abs(error) > 1.5) {
      ++far_off;
    } else {
      squares += error * error;
    }
  }
  const auto count = static_cast<double>(seeds.size());
  EXPECT_NEAR(far_off / count, 0.1, 0.015);
  EXPECT_NEAR(std::sqrt(squares / (count - far_off)), 0.25, 0.02);
}

TEST(SimulateSeeds, RepeatsItselfAndKeepsTheOthersInPlace) {
  const cv::Mat truth(100, 100, CV_32FC1, cv::Scalar(20.0F));
  SeedSimulation simulation;
  const Seeds once = simulateSeeds(truth, {0, 64}, simulation);
  const Seeds again = simulateSeeds(truth, {0, 64}, simulation);
  simulation.outliers = 0.5;
  const Seeds wilder = simulateSeeds(truth, {0, 64}, simulation);
  ASSERT_EQ(once.size(), again.size());
  ASSERT_EQ(once.size(), wilder.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].d, again[i].d);
    EXPECT_EQ(once[i].x, wilder[i].x);
    EXPECT_EQ(once[i].y, wilder[i].y);
  }
}

}  // namespace
}  // namespace fdp_stereo
