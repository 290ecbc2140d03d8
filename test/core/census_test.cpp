// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/census.hpp"

#include <gtest/gtest.h>

#include "reference/census_reference.hpp"
#include "reference/instruction_sets.hpp"
#include "reference/random_images.hpp"

namespace fdp_stereo {
namespace {

std::vector<std::uint64_t> codesOf(const cv::Mat& grey, int width, int height) {
  std::vector<std::uint64_t> codes;
  computeCensus(grey, {width, height}, codes);
  return codes;
}

int bits(std::uint64_t code) { return __builtin_popcountll(code); }

TEST(Census, HandWorkedCase) {
  // Around the centre 5 the values 1, 4, 2 and 3 are below it.
  const cv::Mat grey = (cv::Mat_<std::uint8_t>(3, 3) << 9, 1, 6, 4, 5, 8, 2, 7, 3);
  const std::vector<std::uint64_t> codes = codesOf(grey, 3, 3);
  EXPECT_EQ(bits(codes[4]), 4);
  // Around (0, 0) the window holds 9 9 1 / 9 9 1 / 4 4 5, the border repeated: five neighbours are below 9.
  EXPECT_EQ(bits(codes[0]), 5);
}

TEST(Census, DistancesEqualTheReference) {
  for (const auto& [width, height] : {std::pair{3, 3}, {9, 7}, {5, 5}, {1, 3}, {7, 1}, {11, 5}, {13, 5}}) {
    for (const auto& [rows, cols] : {std::pair{1, 17}, {17, 1}, {5, 33}, {12, 21}}) {
      const cv::Mat a = reference::noise(rows, cols, CV_8UC1, 1);
      const cv::Mat b = reference::noise(rows, cols, CV_8UC1, 2);
      const auto codes_a = codesOf(a, width, height);
      const auto codes_b = codesOf(b, width, height);
      ASSERT_EQ(codes_a.size(), a.total());
      for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < cols; ++x) {
          const cv::Point other((x * 7 + 3) % cols, (y * 5 + 1) % rows);
          ASSERT_EQ(bits(codes_a[y * cols + x] ^ codes_b[other.y * cols + other.x]),
                    reference::censusDistance(a, {x, y}, b, other, width, height))
              << width << " x " << height << " at " << x << ", " << y;
        }
      }
    }
  }
}

TEST(Census, KeepsTheDepthOf16Bit) {
  // Values that differ only in their lower byte.
  const cv::Mat grey = (cv::Mat_<std::uint16_t>(1, 5) << 30001, 30002, 30003, 30004, 30005);
  EXPECT_EQ(bits(codesOf(grey, 5, 1)[2]), 2);
  cv::Mat wide;
  const cv::Mat narrow = reference::noise(9, 15, CV_8UC1, 5);
  narrow.convertTo(wide, CV_16U, 200.0);
  EXPECT_EQ(codesOf(wide, 9, 7), codesOf(narrow, 9, 7));
}

TEST(Census, DoesNotSeeBrightness) {
  const cv::Mat grey = reference::noise(11, 19, CV_8UC1, 4) / 2;
  EXPECT_EQ(codesOf(grey, 9, 7), codesOf(grey + 100, 9, 7));
}

TEST(Census, AConstantImageHasNoBits) {
  for (const std::uint64_t code : codesOf(cv::Mat(6, 7, CV_8UC1, cv::Scalar(77)), 9, 7)) EXPECT_EQ(code, 0U);
}

using CensusKernel = reference::EveryInstructionSet;
FDP_STEREO_INSTANTIATE_INSTRUCTION_SETS(CensusKernel);

TEST_P(CensusKernel, GivesTheSameBits) {
  for (const int type : {CV_8UC1, CV_16UC1}) {
    cv::Mat grey;
    reference::noise(23, 71, CV_8UC1, 6).convertTo(grey, type);
    const auto codes = [&] { return codesOf(grey, 9, 7); };
    EXPECT_EQ(onThisSet(codes), onBaseline(codes));
  }
}

TEST(Census, RefusesOtherTypesAndLargerWindows) {
  EXPECT_THROW(codesOf(cv::Mat(3, 3, CV_8UC3), 3, 3), std::invalid_argument);
  EXPECT_THROW(codesOf(cv::Mat(3, 3, CV_32FC1), 3, 3), std::invalid_argument);
  EXPECT_THROW(codesOf(cv::Mat(3, 3, CV_8UC1), 9, 9), std::invalid_argument);
}

}  // namespace
}  // namespace fdp_stereo
