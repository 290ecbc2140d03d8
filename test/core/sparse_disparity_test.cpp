// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/sparse_disparity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utils/filesystem.hpp>
#include <opencv2/imgproc.hpp>

#include "evaluation/scene.hpp"
#include "fdp_stereo/feature_matching.hpp"
#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/row_alignment.hpp"
#include "seeds/seed_grid.hpp"
#include "seeds/seed_verification.hpp"

namespace fdp_stereo {
namespace {

/// A textured pair, all of it at one disparity.
StereoPair texturedPair(cv::Size size, int disparity) {
  cv::Mat noise(size.height, size.width + disparity, CV_8UC1);
  cv::RNG(11).fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {}, 1.2);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return prepareImages(noise(cv::Rect(0, 0, size.width, size.height)).clone(),
                       noise(cv::Rect(disparity, 0, size.width, size.height)).clone());
}

FeatureMatch matchAt(float x, float y, float d, float row_residual = 0.0F) {
  FeatureMatch match;
  match.left = {x, y};
  match.right = {x - d, y - row_residual};
  match.trust = 0.8F;
  return match;
}

Seed externalAt(float x, float y, float d) {
  Seed seed;
  seed.x = x;
  seed.y = y;
  seed.d = d;
  seed.source = SeedSource::kPoints;
  return seed;
}

/// Right matches on a grid over a pair of disparity 10.
FeatureMatches rightMatches() {
  FeatureMatches matches;
  for (int y = 20; y < 100; y += 16) {
    for (int x = 30; x < 150; x += 16) matches.push_back(matchAt(static_cast<float>(x), static_cast<float>(y), 10.0F));
  }
  return matches;
}

bool ordered(const Seeds& seeds) {
  for (std::size_t i = 1; i < seeds.size(); ++i) {
    if (std::tie(seeds[i].y, seeds[i].x) < std::tie(seeds[i - 1].y, seeds[i - 1].x)) return false;
  }
  return true;
}

TEST(SparseDisparity, KeepsWhatAgreesAndRejectsTheRest) {
  const StereoPair pair = texturedPair({160, 120}, 10);
  FeatureMatches matches = rightMatches();
  const std::size_t right = matches.size();
  matches.push_back(matchAt(70.0F, 60.0F, 10.0F, 1.0F));  // off its row
  matches.push_back(matchAt(85.0F, 45.0F, 17.0F));        // not what the images say
  const SparseDisparity sparse = buildSparseDisparity(matches, {}, pair, {0, 32}, {});
  EXPECT_EQ(sparse.seeds.size(), right);
  ASSERT_EQ(sparse.rejected.size(), 2U);
  EXPECT_EQ(sparse.rejected[0].d, 17.0F);
  EXPECT_EQ(sparse.rejected[1].y, 60.0F);
  for (const Seed& seed : sparse.seeds) {
    EXPECT_EQ(seed.d, 10.0F);
    EXPECT_GT(seed.trust, 0.4F);
    EXPECT_LE(seed.trust, 0.8F);
    EXPECT_EQ(seed.source, SeedSource::kFeature);
  }
  EXPECT_TRUE(ordered(sparse.seeds));
  EXPECT_TRUE(ordered(sparse.rejected));
}

TEST(SparseDisparity, ExternalSeedsAnswerToTheirNeighbours) {
  const StereoPair pair = texturedPair({160, 120}, 10);
  Seeds external;
  for (int y = 5; y < 120; y += 10) {  // a slanted plane, which the images know nothing of
    for (int x = 5; x < 160; x += 10) {
      external.push_back(
          externalAt(static_cast<float>(x), static_cast<float>(y), 5.0F + 0.05F * static_cast<float>(x)));
    }
  }
  const std::size_t right = external.size();
  external.push_back(externalAt(80.0F, 60.0F, 25.0F));
  const SparseDisparity sparse = buildSparseDisparity({}, external, pair, {0, 32}, {});
  EXPECT_EQ(sparse.seeds.size(), right);
  ASSERT_EQ(sparse.rejected.size(), 1U);
  EXPECT_EQ(sparse.rejected.front().d, 25.0F);
}

TEST(SparseDisparity, DropsWhatIsOutside) {
  const StereoPair pair = texturedPair({160, 120}, 10);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  SparseDisparityParams params;
  params.reject_outliers = false;
  const Seeds external = {externalAt(-1.0F, 5.0F, 3.0F), externalAt(5.0F, 120.0F, 3.0F), externalAt(5.0F, 5.0F, 32.0F),
                          externalAt(5.0F, 5.0F, -1.0F), externalAt(nan, 5.0F, 3.0F),    externalAt(5.0F, 5.0F, nan)};
  const SparseDisparity sparse = buildSparseDisparity({}, external, pair, {0, 32}, params);
  EXPECT_TRUE(sparse.seeds.empty());
  EXPECT_TRUE(sparse.rejected.empty());
}

TEST(SparseDisparity, PaperTrustsEveryMatch) {
  const StereoPair pair = texturedPair({160, 120}, 10);
  SparseDisparityParams params;
  params.reject_outliers = false;
  const SparseDisparity sparse = buildSparseDisparity({matchAt(70.0F, 60.0F, 20.0F, 1.0F)}, {}, pair, {0, 32}, params);
  ASSERT_EQ(sparse.seeds.size(), 1U);
  EXPECT_EQ(sparse.seeds.front().trust, 0.8F);
}

TEST(SparseDisparity, NothingGivesNothing) {
  const SparseDisparity sparse = buildSparseDisparity({}, {}, texturedPair({9, 7}, 1), {0, 4}, {});
  EXPECT_TRUE(sparse.seeds.empty());
  EXPECT_TRUE(sparse.rejected.empty());
}

TEST(WindowDeviation, SmallOnASurfaceLargeElsewhere) {
  const StereoPair pair = texturedPair({160, 120}, 10);
  EXPECT_LT(windowDeviation(pair.left, pair.right, {80, 60}, 10.0F), 0.15F);
  EXPECT_NEAR(windowDeviation(pair.left, pair.right, {80, 60}, 10.4F), 0.4F, 0.1F);
  EXPECT_GT(windowDeviation(pair.left, pair.right, {80, 60}, 17.0F), 1.9F);
  EXPECT_LT(windowDeviation(pair.left, pair.right, {159, 60}, 10.0F), 1.0F);  // half of the patch is outside
  cv::Mat darker;
  pair.right.convertTo(darker, CV_8U, 0.6, 20.0);
  EXPECT_LT(windowDeviation(pair.left, darker, {80, 60}, 10.0F), 0.15F);
}

// The left half lies at 10, the right half at 18: a seed beside the seam sees both.
TEST(WindowDeviation, LargeBesideADepthEdge) {
  const StereoPair far = texturedPair({160, 120}, 10);
  const StereoPair near = texturedPair({160, 120}, 18);
  cv::Mat left = far.left.clone();
  cv::Mat right = far.right.clone();
  near.left(cv::Rect(80, 0, 80, 120)).copyTo(left(cv::Rect(80, 0, 80, 120)));
  near.right(cv::Rect(62, 0, 98, 120)).copyTo(right(cv::Rect(62, 0, 98, 120)));
  EXPECT_LT(windowDeviation(left, right, {100, 60}, 18.0F), 0.1F);
  EXPECT_GT(windowDeviation(left, right, {79, 60}, 18.0F), 0.7F);
}

TEST(SeedGrid, EqualsTheReference) {
  cv::RNG rng(3);
  Seeds seeds;
  for (int i = 0; i < 400; ++i) seeds.push_back(externalAt(rng.uniform(0.0F, 199.0F), rng.uniform(0.0F, 99.0F), 1.0F));
  const SeedGrid grid(seeds, {200, 100});
  for (int i = 0; i < 400; i += 7) {
    std::vector<std::pair<float, int>> expected;
    for (int j = 0; j < 400; ++j) {
      if (j != i) expected.emplace_back(std::hypot(seeds[j].x - seeds[i].x, seeds[j].y - seeds[i].y), j);
    }
    std::sort(expected.begin(), expected.end());
    const auto found = grid.nearest(i, 5);
    ASSERT_EQ(found.size(), 5U);
    for (int k = 0; k < 5; ++k) EXPECT_EQ(found[k].index, expected[k].second);
  }
}

/// Truth at the nearest pixel within 5 px that has it; NaN where none has.
float truthNear(const cv::Mat& truth, float x, float y) {
  const cv::Point at(cvRound(x), cvRound(y));
  float found = std::numeric_limits<float>::quiet_NaN();
  int best = 26;
  for (int j = -5; j <= 5; ++j) {
    for (int i = -5; i <= 5; ++i) {
      const cv::Point p = at + cv::Point(i, j);
      if (!cv::Rect(0, 0, truth.cols, truth.rows).contains(p) || i * i + j * j >= best) continue;
      if (std::isnan(truth.at<float>(p))) continue;
      best = i * i + j * j;
      found = truth.at<float>(p);
    }
  }
  return found;
}

// Of the matches that pass ratio and rows 10 to 28 % are wrong by more than 1 px on these scenes.
TEST(SparseDisparity, FewWrongSeedsOnRealScenes) {
  const std::string folder = FDP_STEREO_SOURCE_DIR "/../shared/data/MiddEval3-trainingQ/";
  FeatureMatchingParams features;
  features.detector = FeatureDetector::kFastCensus;
  features.max_ratio = 0.8;
  features.max_row_difference_px = 4.0;
  features.max_features = 1500;
  double wrong_share = 0.0;
  double kept_share = 0.0;
  const char* names[] = {"Adirondack", "Motorcycle", "Piano", "PianoL", "Pipes", "Playtable", "Recycle", "Teddy"};
  for (const char* name : names) {
    if (!cv::utils::fs::exists(folder + name)) GTEST_SKIP() << "no scene at " << folder << name;
    const Scene scene = readScene(findScenes(folder + name).front());
    StereoPair pair = prepareImages(scene.left, scene.right);
    const DisparityRange range{0, scene.num_disparities};
    const FeatureMatches given = matchFeatures(pair, range, features).matches;
    const RowOffsetModel model = estimateRowAlignment(given, pair.left.size(), {}).model;
    pair.right = alignRows(pair.right, model);
    pair.right_grey = alignRows(pair.right_grey, model);
    const SparseDisparity sparse = buildSparseDisparity(alignMatches(given, model), {}, pair, range, {});
    int matches_right = 0;
    for (const FeatureMatch& m : given) {
      matches_right += std::abs(truthNear(scene.truth, m.left.x, m.left.y) - m.disparity()) <= 1.0F ? 1 : 0;
    }
    int right = 0;
    int wrong = 0;
    for (const Seed& s : sparse.seeds) {
      const float error = std::abs(truthNear(scene.truth, s.x, s.y) - s.d);
      right += error <= 1.0F ? 1 : 0;
      wrong += error > 1.0F ? 1 : 0;
    }
    wrong_share += 100.0 * wrong / (right + wrong) / 8.0;
    kept_share += 100.0 * right / matches_right / 8.0;
  }
  EXPECT_LE(wrong_share, 2.0);
  EXPECT_GE(kept_share, 60.0);
}

TEST(SparseDisparity, PictureShowsSeedsAndRejected) {
  const cv::Mat left(40, 60, CV_8UC1, cv::Scalar(100));
  SparseDisparity sparse;
  sparse.seeds = {externalAt(10.0F, 10.0F, 5.0F)};
  sparse.rejected = {externalAt(40.0F, 20.0F, 5.0F)};
  const cv::Mat picture = drawSeeds(left, sparse, {0, 16});
  ASSERT_EQ(picture.type(), CV_8UC3);
  const cv::Vec3b background(50, 50, 50);
  EXPECT_EQ(picture.at<cv::Vec3b>(30, 5), background);
  EXPECT_NE(picture.at<cv::Vec3b>(10, 10), background);
  EXPECT_NE(picture.at<cv::Vec3b>(20, 40), background);
  EXPECT_NE(picture.at<cv::Vec3b>(10, 10), picture.at<cv::Vec3b>(20, 40));
}

}  // namespace
}  // namespace fdp_stereo
