// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/row_alignment.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/feature_matching.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/row_alignment_reference.hpp"

namespace fdp_stereo {
namespace {

const cv::Size kSize(640, 480);

/// Vertical offset in px at normalised right-image coordinates u, v in [-1, 1].
using Field = std::function<double(double, double)>;

double u(double x, cv::Size size) { return 2.0 * x / (size.width - 1) - 1.0; }
double v(double y, cv::Size size) { return 2.0 * y / (size.height - 1) - 1.0; }

/// Matches all over the image whose rows are off by the field and noise; a share of them by anything.
FeatureMatches makeMatches(const Field& field, int count, double outliers, double noise_px, int seed) {
  cv::RNG rng(seed);
  FeatureMatches matches;
  for (int i = 0; i < count; ++i) {
    FeatureMatch m;
    m.left = {rng.uniform(40.0F, 639.0F), rng.uniform(0.0F, 479.0F)};
    m.right.x = m.left.x - rng.uniform(0.0F, 40.0F);
    const bool wrong = rng.uniform(0.0, 1.0) < outliers;
    const double dv =
        wrong ? rng.uniform(-4.0, 4.0) : field(u(m.right.x, kSize), v(m.left.y, kSize)) + rng.gaussian(noise_px);
    m.right.y = m.left.y - static_cast<float>(dv);
    matches.push_back(m);
  }
  return matches;
}

/// RMS over the image of model - field.
double fieldError(const RowOffsetModel& model, const Field& field, cv::Size size) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < size.height; y += 16) {
    for (int x = 0; x < size.width; x += 16) {
      const double difference = model.offsetAt(x, y) - field(u(x, size), v(y, size));
      sum += difference * difference;
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

struct Warp {
  const char* name;
  Field field;
};

const Warp kWarps[] = {
    {"shift", [](double, double) { return 0.8; }},
    {"roll", [](double x, double) { return -0.3 + 1.4 * x; }},
    {"scale", [](double, double y) { return 1.1 * y; }},
    {"pitch", [](double, double y) { return 1.0 + 0.5 * y * y; }},
    {"yaw", [](double x, double y) { return 1.2 * x * y; }},
    {"radial_remains", [](double x, double y) { return 0.6 * y * (x * x + 0.5625 * y * y); }},
    {"all_of_it", [](double x, double y) { return 1.0 - 0.9 * x + 0.6 * y + 0.3 * x * y - 0.4 * x * x; }},
};

class KnownWarp : public ::testing::TestWithParam<Warp> {};

TEST_P(KnownWarp, RecoveredFromHundredMatchesWithOutliers) {
  for (int seed = 1; seed <= 5; ++seed) {
    const FeatureMatches matches = makeMatches(GetParam().field, 120, 0.2, 0.08, seed);
    const RowAlignment result = estimateRowAlignment(matches, kSize, {});
    EXPECT_LT(fieldError(result.model, GetParam().field, kSize), 0.05) << result.note;
    EXPECT_GT(result.matches_used, 80);
    EXPECT_LT(result.rms_after_px, 0.2);
    EXPECT_GE(result.rms_before_px, result.rms_after_px);
  }
}

INSTANTIATE_TEST_SUITE_P(Warps, KnownWarp, ::testing::ValuesIn(kWarps),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(RowAlignment, TakesTheSmallestOrderThatTheMatchesSupport) {
  EXPECT_EQ(estimateRowAlignment(makeMatches(kWarps[0].field, 300, 0.1, 0.1, 7), kSize, {}).model.order, 0);
  EXPECT_EQ(estimateRowAlignment(makeMatches(kWarps[1].field, 300, 0.1, 0.1, 7), kSize, {}).model.order, 1);
  EXPECT_EQ(estimateRowAlignment(makeMatches(kWarps[6].field, 300, 0.1, 0.1, 7), kSize, {}).model.order, 2);
  EXPECT_EQ(estimateRowAlignment(makeMatches(kWarps[5].field, 300, 0.1, 0.1, 7), kSize, {}).model.order, 3);
  RowAlignmentParams affine;
  affine.model = RowAlignmentModel::kAffine;
  EXPECT_EQ(estimateRowAlignment(makeMatches(kWarps[6].field, 300, 0.1, 0.1, 7), kSize, affine).model.order, 1);
}

TEST(RowAlignment, AlignedRowsStayAsTheyAre) {
  for (int seed = 1; seed <= 20; ++seed) {
    const Field none = [](double, double) { return 0.0; };
    const RowAlignment result = estimateRowAlignment(makeMatches(none, 60 + 20 * seed, 0.2, 0.2, seed), kSize, {});
    EXPECT_TRUE(result.model.identity()) << result.note;
    EXPECT_TRUE(result.warning.empty());
    EXPECT_EQ(result.rms_before_px, result.rms_after_px);
  }
}

TEST(RowAlignment, DegenerateMatchesGiveTheIdentity) {
  const Field shift = kWarps[0].field;
  EXPECT_TRUE(estimateRowAlignment({}, kSize, {}).model.identity());
  EXPECT_TRUE(estimateRowAlignment(makeMatches(shift, 5, 0.0, 0.1, 1), kSize, {}).model.identity());
  for (int seed = 1; seed <= 20; ++seed) {
    EXPECT_TRUE(estimateRowAlignment(makeMatches(shift, 200, 1.0, 0.1, seed), kSize, {}).model.identity()) << seed;
  }
  FeatureMatches one_row = makeMatches(shift, 200, 0.0, 0.1, 2);
  FeatureMatches one_column = one_row;
  for (FeatureMatch& m : one_row) {
    m.right.y += 100.0F - m.left.y;
    m.left.y = 100.0F;
  }
  for (FeatureMatch& m : one_column) m.left.x = m.right.x = 300.0F;
  FeatureMatches one_point(200, one_row.front());
  for (const FeatureMatches& matches : {one_row, one_column, one_point}) {
    const RowAlignment result = estimateRowAlignment(matches, kSize, {});
    EXPECT_TRUE(result.model.identity()) << result.note;
    EXPECT_FALSE(result.note.empty());
  }
  EXPECT_NO_THROW(estimateRowAlignment(one_row, {1, 1}, {}));
}

TEST(RowAlignment, WarnsAboveTheLimitOnly) {
  const FeatureMatches matches = makeMatches(kWarps[0].field, 200, 0.1, 0.1, 3);
  RowAlignmentParams params;
  EXPECT_NE(estimateRowAlignment(matches, kSize, params).warning.find("calibrate"), std::string::npos);
  params.warn_px = 0.9;
  EXPECT_TRUE(estimateRowAlignment(matches, kSize, params).warning.empty());
}

TEST(RowAlignment, AlignedMatchesLieOnTheirRows) {
  const FeatureMatches matches = makeMatches(kWarps[1].field, 200, 0.0, 0.0, 3);
  const RowAlignment result = estimateRowAlignment(matches, kSize, {});
  for (const FeatureMatch& m : alignMatches(matches, result.model)) EXPECT_NEAR(m.rowResidual(), 0.0, 0.01);
}

RowOffsetModel someModel(cv::Size size) {
  RowOffsetModel model;
  model.order = 2;
  model.size = size;
  model.coefficients << 0.4, -1.3, 0.7, 0.2, 0.5, -0.3, 0.0;
  return model;
}

class Resampling : public ::testing::TestWithParam<int> {};

// The eight columns of a block share one offset, kept to 1/64 px: with this model less than 0.04 px off, so less than
// 3 % of full scale on this texture.
TEST_P(Resampling, EqualsTheReference) {
  for (const cv::Size size : {cv::Size(321, 97), cv::Size(33, 5), cv::Size(7, 1), cv::Size(1, 40)}) {
    cv::Mat noise(size, GetParam());
    const double full = noise.depth() == CV_8U ? 255.0 : 65535.0;
    cv::RNG(9).fill(noise, cv::RNG::UNIFORM, 0.0, full);
    cv::Mat right;
    cv::GaussianBlur(noise, right, {}, 1.5);
    RowOffsetModel model = someModel(size);
    if (size.width < 100) model.coefficients.tail(6) *= size.width / 320.0;
    const cv::Mat aligned = alignRows(right, model);
    ASSERT_EQ(aligned.type(), right.type());
    ASSERT_EQ(aligned.size(), right.size());
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        for (int c = 0; c < right.channels(); ++c) {
          const int i = right.channels() * x + c;
          const double value = right.depth() == CV_8U ? aligned.ptr<uchar>(y)[i] : aligned.ptr<ushort>(y)[i];
          ASSERT_NEAR(value, reference::alignedValue(right, model, y, x, c), 0.03 * full);
        }
      }
    }
  }
}

TEST_P(Resampling, ConstantStaysConstant) {
  const cv::Mat constant(60, 80, GetParam(), cv::Scalar::all(251));
  EXPECT_EQ(cv::norm(alignRows(constant, someModel(constant.size())), constant, cv::NORM_INF), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Types, Resampling, ::testing::Values(CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3));

using ResamplingKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(ResamplingKernel);

TEST_P(ResamplingKernel, GivesTheSameBitsOnBentRows) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    cv::Mat noise(60, 83, type);
    cv::RNG(4).fill(noise, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_8U ? 256 : 65536);
    const auto aligned = [&] { return alignRows(noise, someModel(noise.size())); };
    EXPECT_EQ(cv::norm(onThisSet(aligned), onBaseline(aligned), cv::NORM_INF), 0.0);
  }
}

TEST(RowAlignment, IntegerShiftMovesRows) {
  cv::Mat right(20, 30, CV_8UC1);
  cv::RNG(2).fill(right, cv::RNG::UNIFORM, 0, 255);
  RowOffsetModel model;
  model.order = 0;
  model.size = right.size();
  model.coefficients(0) = 2.0;  // left row y shows what right row y - 2 shows
  const cv::Mat aligned = alignRows(right, model);
  EXPECT_EQ(cv::norm(aligned.rowRange(2, 20), right.rowRange(0, 18), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(aligned.row(0), right.row(0), cv::NORM_INF), 0.0);
}

TEST(RowAlignment, IdentitySharesTheImage) {
  const cv::Mat right(20, 30, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_EQ(alignRows(right, RowOffsetModel()).data, right.data);
}

TEST(RowAlignment, RefusesWhatItCannotResample) {
  const RowOffsetModel model = someModel({30, 20});
  EXPECT_THROW(alignRows(cv::Mat(20, 30, CV_32FC1, cv::Scalar(0)), model), std::invalid_argument);
  EXPECT_THROW(alignRows(cv::Mat(20, 30, CV_8UC2, cv::Scalar(0)), model), std::invalid_argument);
  EXPECT_THROW(alignRows(cv::Mat(20, 31, CV_8UC1, cv::Scalar(0)), model), std::invalid_argument);
}

// Of a real pair: what is warped on top is found on top of what was there.
TEST(RowAlignment, RecoversTheWarpOfARealPair) {
  const std::string scene = FDP_STEREO_SOURCE_DIR "/../shared/data/Middlebury-v2/cones/";
  const cv::Mat left = cv::imread(scene + "im0.png");
  const cv::Mat right = cv::imread(scene + "im1.png");
  if (left.empty() || right.empty()) GTEST_SKIP() << "no scene at " << scene;
  FeatureMatchingParams features;
  features.detector = FeatureDetector::kFastCensus;
  features.max_ratio = 0.8;
  features.max_row_difference_px = 4.0;
  const auto estimateOf = [&](const cv::Mat& image) {
    StereoPair pair;
    pair.left = left;
    pair.right = image;
    return estimateRowAlignment(matchFeatures(pair, {0, 64}, features).matches, left.size(), {});
  };
  const RowAlignment before = estimateOf(right);
  RowOffsetModel warp;
  warp.order = 1;
  warp.size = left.size();
  warp.coefficients << -1.0, 0.9, -0.6, 0.0, 0.0, 0.0, 0.0;
  const RowAlignment after = estimateOf(alignRows(right, warp));
  const Field expected = [&](double x, double y) {
    const double column = (x + 1.0) / 2.0 * (left.cols - 1);
    const double row = (y + 1.0) / 2.0 * (left.rows - 1);
    return before.model.offsetAt(column, row) - warp.offsetAt(column, row);
  };
  EXPECT_LT(fieldError(after.model, expected, left.size()), 0.05) << after.note;
}

RowAlignmentParams accumulate() {
  RowAlignmentParams params;
  params.mode = RowAlignmentMode::kAccumulate;
  return params;
}

TEST(RowAlignmentAccumulator, FewMatchesPerFrameAddUp) {
  const Field field = kWarps[1].field;
  RowAlignmentAccumulator stream;
  RowAlignment result;
  for (int frame = 0; frame < 10; ++frame) {
    const FeatureMatches matches = makeMatches(field, 25, 0.2, 0.1, 100 + frame);
    EXPECT_LT(estimateRowAlignment(matches, kSize, {}).model.order, 1);
    result = stream.update(matches, kSize, accumulate());
  }
  EXPECT_EQ(result.model.order, 1);
  EXPECT_LT(fieldError(result.model, field, kSize), 0.05);
}

TEST(RowAlignmentAccumulator, StartsAnewWhenTheCamerasMove) {
  RowAlignmentAccumulator stream;
  for (int frame = 0; frame < 10; ++frame)
    stream.update(makeMatches(kWarps[0].field, 150, 0.2, 0.1, frame), kSize, accumulate());
  const Field moved = [](double x, double) { return -0.7 + 0.5 * x; };
  const RowAlignment first = stream.update(makeMatches(moved, 150, 0.2, 0.1, 50), kSize, accumulate());
  EXPECT_LT(fieldError(first.model, moved, kSize), 0.05) << first.note;
}

TEST(RowAlignmentAccumulator, FollowsASlowDrift) {
  RowAlignmentAccumulator stream;
  double offset = 0.2;
  RowAlignment result;
  for (int frame = 0; frame < 60; ++frame) {
    offset += 0.01;
    const Field field = [&](double, double) { return offset; };
    result = stream.update(makeMatches(field, 100, 0.2, 0.1, frame), kSize, accumulate());
  }
  EXPECT_NEAR(result.model.offsetAt(320, 240), offset, 0.06);
}

TEST(RowAlignmentAccumulator, SameSequenceSameResultAndResetForgets) {
  RowAlignmentAccumulator a;
  RowAlignmentAccumulator b;
  b.update(makeMatches(kWarps[2].field, 200, 0.1, 0.1, 77), kSize, accumulate());
  b.reset();
  for (int frame = 0; frame < 5; ++frame) {
    const FeatureMatches matches = makeMatches(kWarps[4].field, 80, 0.2, 0.1, frame);
    const RowAlignment ra = a.update(matches, kSize, accumulate());
    const RowAlignment rb = b.update(matches, kSize, accumulate());
    EXPECT_EQ(ra.model.coefficients, rb.model.coefficients);
    EXPECT_EQ(ra.note, rb.note);
  }
}

TEST(RowAlignmentAccumulator, PerFrameHasNoMemory) {
  RowAlignmentAccumulator stream;
  stream.update(makeMatches(kWarps[2].field, 200, 0.1, 0.1, 77), kSize, {});
  const FeatureMatches matches = makeMatches(kWarps[4].field, 80, 0.2, 0.1, 5);
  EXPECT_EQ(stream.update(matches, kSize, {}).model.coefficients,
            estimateRowAlignment(matches, kSize, {}).model.coefficients);
}

TEST(RowAlignment, PictureShowsOffsetsAndResiduals) {
  const cv::Mat left(kSize, CV_8UC1, cv::Scalar(100));
  const FeatureMatches matches = makeMatches(kWarps[1].field, 150, 0.1, 0.1, 3);
  const RowAlignment result = estimateRowAlignment(matches, kSize, {});
  const cv::Mat field = drawRowAlignment(left, {}, result);
  ASSERT_EQ(field.type(), CV_8UC3);
  ASSERT_EQ(field.size(), kSize);
  const auto left_side = field.at<cv::Vec3b>(240, 5);     // -1.7 px: blue
  const auto right_side = field.at<cv::Vec3b>(240, 634);  // 1.1 px: red
  EXPECT_GT(left_side[0], left_side[2]);
  EXPECT_GT(right_side[2], right_side[0]);
  EXPECT_GT(cv::norm(field, drawRowAlignment(left, matches, result), cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace fdp_stereo
