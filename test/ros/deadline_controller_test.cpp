// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "deadline_controller.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace fdp_stereo {
namespace {

constexpr double kDeadline = 50.0;  // ms

/// A machine on which a pair at full size takes 32 ms.
class Machine {
 public:
  explicit Machine(double wanted = 1.0, unsigned seed = 1) : wanted_(wanted), random_(seed) {}

  /// Works on so many pairs; load: how much longer everything takes.
  void run(int pairs, double load, double noise = 0.05) {
    std::normal_distribution<double> jitter(1.0, noise);
    for (int i = 0; i < pairs; ++i) {
      const double scale = controller.scale(wanted_);
      const double full_share = scale / wanted_;
      const double ms = load * std::max(0.5, jitter(random_)) * (6.0 + 26.0 * full_share * full_share);
      add(ms, scale);
    }
  }
  void add(double ms, double scale) {
    times.push_back(ms);
    scales.push_back(scale);
    controller.record(ms, kDeadline, wanted_);
  }
  double percentile95() const {
    std::vector<double> sorted = times;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() * 95 / 100];
  }
  int changes() const {
    int count = 0;
    for (std::size_t i = 1; i < scales.size(); ++i) count += scales[i] != scales[i - 1] ? 1 : 0;
    return count;
  }
  void clear() {
    times.clear();
    scales.clear();
  }

  DeadlineController controller;
  std::vector<double> times, scales;

 private:
  double wanted_;
  std::mt19937 random_;
};

TEST(DeadlineController, LeavesWhatFitsAlone) {
  Machine machine;
  machine.run(500, 1.0);
  EXPECT_EQ(machine.changes(), 0);
  EXPECT_EQ(machine.controller.scale(1.0), 1.0);
}

TEST(DeadlineController, LoadComesAndGoes) {
  for (const double load : {1.5, 2.0, 3.0, 5.0}) {
    Machine machine;
    machine.run(100, 1.0);
    machine.run(400, load);
    EXPECT_LT(machine.percentile95(), kDeadline) << load;
    EXPECT_LT(machine.scales.back(), 1.0) << load;
    machine.run(300, 1.0);
    EXPECT_EQ(machine.scales.back(), 1.0) << load << ": quality returns";
  }
}

TEST(DeadlineController, TwoLatePairsAreEnough) {
  Machine machine;
  machine.run(30, 1.0);
  machine.run(2, 2.0);
  EXPECT_LT(machine.controller.scale(1.0), 1.0);
  machine.clear();
  machine.run(60, 2.0);
  EXPECT_LT(machine.percentile95(), kDeadline);
}

TEST(DeadlineController, ASinglePairThatIsSlowChangesNothing) {
  Machine machine;
  for (int i = 0; i < 20; ++i) {
    machine.run(25, 1.0);
    machine.add(20 * kDeadline, machine.controller.scale(1.0));
  }
  EXPECT_EQ(machine.changes(), 0);
  machine.run(200, 2.0);
  const double scale = machine.controller.scale(1.0);
  machine.clear();
  for (int i = 0; i < 10; ++i) {
    machine.run(25, 2.0);
    machine.add(20 * kDeadline, machine.controller.scale(1.0));
  }
  EXPECT_EQ(machine.controller.scale(1.0), scale);
  EXPECT_EQ(machine.changes(), 0);
}

/// Whatever the load is, a scale lasts; also where two of them are nearly right, and with times that vary much.
TEST(DeadlineController, NeverOscillates) {
  for (const double noise : {0.0, 0.05, 0.15}) {
    for (double load = 0.8; load < 8.0; load *= 1.03) {
      Machine machine;
      machine.run(100, load, noise);
      machine.clear();
      machine.run(3000, load, noise);
      EXPECT_LE(machine.changes(), 40) << load << ", " << noise;
      std::size_t since = 0, shortest = 3000;
      for (std::size_t i = 1; i < machine.scales.size(); ++i) {
        if (machine.scales[i] <= machine.scales[i - 1]) continue;
        if (since > 0) shortest = std::min(shortest, i - since);
        since = i;
      }
      EXPECT_GT(shortest, 20U) << load << ", " << noise;
      if (load < 4.5) {
        EXPECT_LT(machine.percentile95(), kDeadline) << load << ", " << noise;
      }
    }
  }
}

TEST(DeadlineController, KnowsWhatIsBeyondItsReach) {
  Machine machine;
  machine.run(100, 100.0);
  EXPECT_EQ(machine.controller.scale(1.0), 0.3);
  EXPECT_TRUE(machine.controller.beyondReach());
  machine.run(400, 1.0);
  EXPECT_FALSE(machine.controller.beyondReach());
  EXPECT_EQ(machine.controller.scale(1.0), 1.0);
}

TEST(DeadlineController, KeepsToTheScalesThatAreAllowed) {
  Machine machine(0.5);
  machine.run(100, 100.0);
  EXPECT_EQ(machine.controller.scale(0.5), 0.25);
  EXPECT_TRUE(machine.controller.beyondReach());
  machine.run(400, 1.0);
  EXPECT_EQ(machine.controller.scale(0.5), 0.5);
  Machine smallest(0.25);
  smallest.run(100, 100.0);
  EXPECT_EQ(smallest.controller.scale(0.25), 0.25);
  EXPECT_TRUE(smallest.controller.beyondReach());
}

/// A pair that repeats the one before takes nothing, whatever the scale is.
TEST(DeadlineController, WholeSizeReturnsWhereNothingMoves) {
  Machine machine;
  machine.run(100, 5.0);
  ASSERT_LT(machine.controller.scale(1.0), 0.65);
  for (int i = 0; i < 200; ++i) machine.controller.recordRepeated();
  EXPECT_EQ(machine.controller.scale(1.0), 1.0);
  machine.run(3, 5.0);
  EXPECT_LT(machine.controller.scale(1.0), 0.65) << "until something does";
}

TEST(DeadlineController, SomeRepeatedPairsAmongOthersChangeNothing) {
  Machine machine;
  machine.run(100, 2.0);
  const double scale = machine.controller.scale(1.0);
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 10; ++k) machine.controller.recordRepeated();
    machine.run(1, 2.0);
  }
  EXPECT_EQ(machine.controller.scale(1.0), scale);
}

TEST(DeadlineController, OtherParametersBeginAnew) {
  Machine machine;
  machine.run(30, 1.0);
  machine.run(1, 2.0, 0.0);
  machine.controller.forget();
  machine.run(2, 2.0, 0.0);
  EXPECT_EQ(machine.controller.scale(1.0), 1.0);
  machine.run(1, 2.0, 0.0);
  EXPECT_LT(machine.controller.scale(1.0), 1.0);
}

}  // namespace
}  // namespace fdp_stereo
