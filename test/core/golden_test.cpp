// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the presets give for the sample pair, as checksums in test/golden/sample.txt: a change that nobody meant, or a
// platform that computes otherwise, shows here, with the first stage that differs. Build the target update_golden after
// a change that is meant.
#include "fdp_stereo/pipeline.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "fdp_stereo/io.hpp"
#include "reference/instruction_sets.hpp"

namespace fdp_stereo {
namespace {

const std::string kGolden = FDP_STEREO_SOURCE_DIR "/test/golden/sample.txt";
const std::string kSample = FDP_STEREO_SOURCE_DIR "/sample/motorcycle/";

/// FNV-1a over the bits of numbers; all NaN are one number.
class Checksum {
 public:
  void add(double value) {
    if (std::isnan(value)) value = -1e300;
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    for (int shift = 0; shift < 64; shift += 8) hash_ = (hash_ ^ ((bits >> shift) & 255U)) * 0x100000001b3U;
  }
  void add(cv::Point2f point) {
    add(static_cast<double>(point.x));
    add(static_cast<double>(point.y));
  }
  void add(const cv::Mat& map) {
    for (int y = 0; y < map.rows; ++y) {
      for (int x = 0; x < map.cols; ++x) add(static_cast<double>(map.at<float>(y, x)));
    }
  }
  void add(const Seeds& seeds) {
    for (const Seed& seed : seeds) {
      add(cv::Point2f(seed.x, seed.y));
      add(cv::Point2f(seed.d, seed.trust));
    }
  }
  std::string text() const { return cv::format("%016llx", static_cast<unsigned long long>(hash_)); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

template <typename T>
std::string checksumOf(const T& value) {
  Checksum checksum;
  checksum.add(value);
  return checksum.text();
}

struct StageChecksum {
  std::string stage;
  std::string checksum;
};

/// In the order of the pipeline.
std::vector<StageChecksum> checksumsOf(const PipelineResult& result) {
  Checksum matches;
  for (const FeatureMatch& match : result.matches) {
    matches.add(match.left);
    matches.add(match.right);
  }
  Checksum rows;
  for (int i = 0; i < kRowOffsetTerms; ++i) rows.add(result.row_alignment.model.coefficients[i]);
  return {{"feature_matching", matches.text()},
          {"row_alignment", rows.text()},
          {"sparse_disparity", checksumOf(result.seeds)},
          {"quasi_dense", checksumOf(result.quasi_dense_seeds)},
          {"disparity", checksumOf(result.disparity)},
          {"confidence", checksumOf(result.confidence)},
          {"sigma", checksumOf(result.sigma)}};
}

/// The presets as shipped; those that take seconds on a part of the pair.
PipelineResult runSample(const std::string& preset) {
  const cv::Rect part = preset == "fast" ? cv::Rect(0, 0, 741, 500) : cv::Rect(300, 160, 140, 100);
  PipelineParams params = loadPreset(preset);
  params.search = {0, 64};
  return Pipeline(params).run(readImage(kSample + "left.png")(part), readImage(kSample + "right.png")(part));
}

std::map<std::string, std::string> readGolden() {
  std::map<std::string, std::string> golden;
  std::ifstream file(kGolden);
  std::string preset, stage, checksum;
  while (file >> preset >> stage >> checksum) golden[preset + " " + stage] = checksum;
  return golden;
}

const char* const kPresets[] = {"fast", "light", "accurate", "paper"};
using Golden = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(Golden);

TEST_P(Golden, PresetsGiveTheseBitsForTheSample) {
  const std::map<std::string, std::string> golden = readGolden();
  ASSERT_FALSE(golden.empty()) << kGolden;
  for (const char* preset : kPresets) {
    for (const StageChecksum& actual : checksumsOf(onThisSet([&] { return runSample(preset); }))) {
      const std::string key = preset + (" " + actual.stage);
      EXPECT_EQ(actual.checksum, golden.count(key) == 0 ? "no checksum" : golden.at(key)) << key;
    }
  }
}

TEST(UpdateGolden, DISABLED_WritesTheChecksums) {
  std::ofstream file(kGolden);
  for (const char* preset : kPresets) {
    for (const StageChecksum& of : checksumsOf(runSample(preset))) {
      file << preset << ' ' << of.stage << ' ' << of.checksum << '\n';
    }
  }
  ASSERT_TRUE(file.flush());
}

}  // namespace
}  // namespace fdp_stereo
