// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/expansion_move.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#include <random>
#include <vector>

#include "reference/instruction_sets.hpp"
#include "reference/local_expansion_reference.hpp"

namespace fdp_stereo::local_expansion {
namespace {

constexpr double kLambda = 0.7;
constexpr double kTau = 1.0;
constexpr double kGamma = 60.0;
constexpr double kEpsilon = 0.05;

reference::ReferencePlane plain(const Plane& f) { return {f.a, f.b, f.c}; }

/// The energy pair by pair, in double, from the formula.
double plainEnergy(const cv::Mat& image, const Labels& labels) {
  double sum = 0.0;
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      sum += labels.cost[labels.index(x, y)];
      for (const cv::Point step : {cv::Point(1, 0), cv::Point(1, 1), cv::Point(0, 1), cv::Point(-1, 1)}) {
        const cv::Point q = cv::Point(x, y) + step;
        if (q.x < 0 || q.x >= labels.width || q.y >= labels.height) continue;
        sum += reference::pairCost(image, {x, y}, q, plain(labels.plane(x, y)), plain(labels.plane(q.x, q.y)), kLambda,
                                   kTau, kGamma, kEpsilon);
      }
    }
  }
  return sum;
}

struct Scene {
  cv::Mat image;
  Labels labels;
  std::mt19937 random;

  Scene(int width, int height, int type, int seed) : image(height, width, type), random(seed) {
    cv::RNG colours(seed);
    colours.fill(image, cv::RNG::UNIFORM, 0, 40);
    labels.create(image.size());
    const std::vector<Plane> planes = {randomPlane(), randomPlane(), randomPlane()};
    for (std::size_t i = 0; i < labels.cost.size(); ++i) {
      labels.planes.set(i, planes[random() % 3]);
      labels.cost[i] = value(0.0F, 1.0F);
    }
  }
  float value(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); }
  Plane randomPlane() { return {value(-0.3F, 0.3F), value(-0.3F, 0.3F), value(3.0F, 5.0F)}; }
  Smoothness smoothness() const { return Smoothness(image, {kLambda, kTau, kGamma, kEpsilon}); }
};

TEST(Smoothness, EnergyOfTwoPixelsWorkedByHand) {
  // Colours differ by 2 + 3 + 5 = 3 * gamma: w = exp(-1). Planes 4 and 4.25 differ by 0.25 at both pixels: psi =
  // 0.5.
  cv::Mat image(1, 2, CV_8UC3, cv::Scalar(10, 10, 10));
  image.at<cv::Vec3b>(0, 1) = {12, 13, 15};
  Labels labels;
  labels.create(image.size());
  labels.planes.set(0, {0.0F, 0.0F, 4.0F});
  labels.planes.set(1, {0.0F, 0.0F, 4.25F});
  labels.cost = {0.125F, 0.25F};
  const Smoothness smoothness(image, {2.0, 1.0, 10.0 / 3.0, 0.01});
  EXPECT_NEAR(energyOf(labels, smoothness), 0.375 + 2.0 * std::exp(-1.0) * 0.5, 1e-6);
}

TEST(Smoothness, EnergyIsTheFormula) {
  for (int seed = 0; seed < 20; ++seed) {
    const Scene scene(3 + seed, 12 - seed / 2, seed % 2 == 0 ? CV_8UC3 : CV_8UC1, seed);
    EXPECT_NEAR(energyOf(scene.labels, scene.smoothness()), plainEnergy(scene.image, scene.labels), 1e-3);
  }
}

/// Of all 2^9 ways to hand a plane to the pixels of a 3 x 3 region the move finds the best.
TEST(ExpansionMove, IsTheBestOfAllMoves) {
  for (int seed = 0; seed < 60; ++seed) {
    Scene scene(7, 6, seed % 2 == 0 ? CV_8UC3 : CV_8UC1, seed);
    const std::array<cv::Point, 4> corners = {cv::Point(2, 2), cv::Point(0, 0), cv::Point(4, 3), cv::Point(0, 3)};
    const cv::Rect region(corners[seed % 4], cv::Size(3, 3));
    const Plane plane = scene.randomPlane();
    std::vector<float> costs(9);
    for (float& cost : costs) cost = scene.value(0.0F, 1.0F);
    const double before = plainEnergy(scene.image, scene.labels);
    double best = std::numeric_limits<double>::max();
    for (unsigned takes = 0; takes < 512; ++takes) {
      Labels trial = scene.labels;
      for (int i = 0; i < 9; ++i) {
        if ((takes >> i & 1U) == 0) continue;
        const std::size_t p = trial.index(region.x + i % 3, region.y + i / 3);
        trial.planes.set(p, plane);
        trial.cost[p] = costs[i];
      }
      best = std::min(best, plainEnergy(scene.image, trial));
    }
    const Smoothness smoothness = scene.smoothness();
    ExpansionMove move;
    move.begin(smoothness, region, scene.labels);
    const double change = move.offer(plane, costs.data());
    const double after = plainEnergy(scene.image, scene.labels);
    EXPECT_NEAR(after, best, 2e-4) << "seed " << seed;
    EXPECT_NEAR(after - before, change, 2e-4) << "seed " << seed;
  }
}

/// The least energy that handing `plane` to pixels of the region can give, by OpenCV's maximum flow.
double leastEnergy(const Scene& scene, const cv::Rect& region, const Plane& plane, const std::vector<float>& costs) {
  const int count = region.area();
  const auto node = [&](cv::Point p) {
    return region.contains(p) ? (p.y - region.y) * region.width + p.x - region.x : -1;
  };
  std::vector<double> linear(count, 0.0);  // cost of taking the plane, less the edges
  cv::detail::GCGraph<double> graph(count, 8 * count);
  for (int i = 0; i < count; ++i) graph.addVtx();
  double constant = 0.0;
  for (int y = 0; y < scene.labels.height; ++y) {
    for (int x = 0; x < scene.labels.width; ++x) {
      const cv::Point p(x, y);
      const double current = scene.labels.cost[scene.labels.index(x, y)];
      constant += current;
      if (node(p) >= 0) linear[node(p)] += static_cast<double>(costs[node(p)]) - current;
      for (const cv::Point step : {cv::Point(1, 0), cv::Point(1, 1), cv::Point(0, 1), cv::Point(-1, 1)}) {
        const cv::Point q = p + step;
        if (q.x < 0 || q.x >= scene.labels.width || q.y >= scene.labels.height) continue;
        const auto pair = [&](const Plane& f, const Plane& g) {
          return reference::pairCost(scene.image, p, q, plain(f), plain(g), kLambda, kTau, kGamma, kEpsilon);
        };
        const Plane f = scene.labels.plane(x, y);
        const Plane g = scene.labels.plane(q.x, q.y);
        const double keep = pair(f, g);
        constant += keep;
        if (node(p) >= 0 && node(q) >= 0) {
          const double edge = std::max(0.0, 0.5 * (pair(plane, g) + pair(f, plane) - keep));
          linear[node(p)] += pair(plane, g) - keep - edge;
          linear[node(q)] += pair(f, plane) - keep - edge;
          graph.addEdges(node(p), node(q), edge, edge);
        } else if (node(p) >= 0) {
          linear[node(p)] += pair(plane, g) - keep;
        } else if (node(q) >= 0) {
          linear[node(q)] += pair(f, plane) - keep;
        }
      }
    }
  }
  for (int i = 0; i < count; ++i) {
    graph.addTermWeights(i, std::max(-linear[i], 0.0), std::max(linear[i], 0.0));
    constant += std::min(linear[i], 0.0);
  }
  return constant + graph.maxFlow();
}

/// Regions too large to try all moves: some pixels are decided by the bounds, some by the cut.
TEST(ExpansionMove, LargeMovesAreAsGoodAsOpenCvsCuts) {
  for (int seed = 0; seed < 40; ++seed) {
    Scene scene(25, 19, seed % 2 == 0 ? CV_8UC3 : CV_8UC1, seed);
    const cv::Rect region(seed % 5, seed % 3, 20 - seed % 4, 16);
    const Smoothness smoothness = scene.smoothness();
    const Plane plane = scene.randomPlane();
    std::vector<float> costs(region.area());
    for (float& cost : costs) cost = scene.value(0.0F, seed % 3 == 0 ? 1.0F : 2.5F);
    const double best = leastEnergy(scene, region, plane, costs);
    ExpansionMove move;
    move.begin(smoothness, region, scene.labels);
    move.offer(plane, costs.data());
    EXPECT_NEAR(plainEnergy(scene.image, scene.labels), best, 1e-3) << "seed " << seed;
  }
}

TEST(ExpansionMove, EnergyNeverRisesAndTheChangeIsTold) {
  Scene scene(41, 33, CV_8UC3, 5);
  const Smoothness smoothness = scene.smoothness();
  ExpansionMove move;
  double energy = energyOf(scene.labels, smoothness);
  for (int i = 0; i < 200; ++i) {
    const cv::Rect region =
        cv::Rect(static_cast<int>(scene.random() % 35), static_cast<int>(scene.random() % 28), 14, 11) &
        cv::Rect(0, 0, 41, 33);
    move.begin(smoothness, region, scene.labels);
    for (int k = 0; k < 3; ++k) {
      std::vector<float> costs(region.area());
      for (float& cost : costs) cost = scene.value(0.0F, 1.5F);
      const double change = move.offer(scene.randomPlane(), costs.data());
      const double after = energyOf(scene.labels, smoothness);
      EXPECT_LE(change, 0.0);
      EXPECT_NEAR(after - energy, change, 1e-3);
      energy = after;
    }
  }
}

TEST(ExpansionMove, UnaryOfferTakesWhatIsCheaper) {
  Scene scene(6, 4, CV_8UC3, 9);
  const Smoothness smoothness = scene.smoothness();
  const Labels before = scene.labels;
  const std::vector<float> costs(24, 0.5F);
  ExpansionMove move;
  move.begin(smoothness, {0, 0, 6, 4}, scene.labels);
  move.offerUnary({0.0F, 0.0F, 9.0F}, costs.data());
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(scene.labels.cost[i], std::min(before.cost[i], 0.5F));
    EXPECT_EQ(scene.labels.planes.get(i).c, before.cost[i] > 0.5F ? 9.0F : before.planes.get(i).c);
  }
}

using ExpansionMoveKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(ExpansionMoveKernel);

TEST_P(ExpansionMoveKernel, TakesTheSamePlanes) {
  const auto offsets = [] {
    Scene scene(37, 29, CV_8UC3, 3);
    const Smoothness smoothness = scene.smoothness();
    ExpansionMove move;
    const cv::Rect region(3, 1, 31, 27);
    move.begin(smoothness, region, scene.labels);
    for (int k = 0; k < 5; ++k) {
      std::vector<float> costs(region.area());
      for (float& cost : costs) cost = scene.value(0.0F, 1.0F);
      move.offer(scene.randomPlane(), costs.data());
    }
    return scene.labels.planes.c;
  };
  EXPECT_EQ(onThisSet(offsets), onBaseline(offsets));
}

}  // namespace
}  // namespace fdp_stereo::local_expansion
