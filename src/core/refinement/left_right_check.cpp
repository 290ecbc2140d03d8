// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/left_right_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "arguments.hpp"
#include "parallel.hpp"
#include "simd/left_right_check_kernels.hpp"

namespace fdp_stereo {
namespace {

/// Of the pixels around that are in the image. A weaker majority lets occluded pixels pass, a stronger one costs
/// answers on weak texture.
constexpr double kMinShare = 0.42;

/// Pixels of the window around p in an image of `size` pixels, along one axis.
int pixelsAround(int p, int size) { return std::min(p + kVoteRadiusPx, size - 1) - std::max(p - kVoteRadiusPx, 0) + 1; }

/// The votes of one row.
class RowVotes {
 public:
  RowVotes(const cv::Mat& disparity, const cv::Mat& counts, float max_difference)
      : disparity_(disparity),
        counts_(counts),
        max_difference_(max_difference),
        nothing_(disparity.cols, kInvalidDisparity),
        sums_(disparity.cols) {}

  void write(int y, float* kept) {
    std::array<const float*, kVoteSide> rows{};
    std::array<const std::uint8_t*, kVoteSide> counts{};
    for (int k = 0; k < kVoteSide; ++k) {
      const int v = y + k - kVoteRadiusPx;
      const bool inside = v >= 0 && v < disparity_.rows;
      rows[k] = inside ? disparity_.ptr<float>(v) : nothing_.data();
      counts[k] = counts_.ptr<std::uint8_t>(inside ? v : y);
    }
    const auto* own = disparity_.ptr<float>(y);
    FDP_STEREO_SELECT(leftRightCheckKernels)
        .sumAlongColumns(own, rows.data(), counts.data(), disparity_.cols, max_difference_, sums_.data());
    const double needed = kMinShare * pixelsAround(y, disparity_.rows);
    for (int x = 0; x < disparity_.cols; ++x) {
      kept[x] = sums_[x] >= needed * pixelsAround(x, disparity_.cols) ? own[x] : kInvalidDisparity;
    }
  }

 private:
  const cv::Mat& disparity_;
  const cv::Mat& counts_;
  float max_difference_;
  std::vector<float> nothing_;
  std::vector<std::int32_t> sums_;
};

void keepSupported(cv::Mat& disparity, const cv::Mat& right, float max_difference) {
  const LeftRightCheckKernels& kernels = FDP_STEREO_SELECT(leftRightCheckKernels);
  const int width = disparity.cols;
  cv::Mat counts(disparity.size(), CV_8UC1), kept(disparity.size(), CV_32FC1);
  const auto makeRow = [&] { return std::vector<float>(width + 2 * kVoteRadiusPx, kInvalidDisparity); };
  parallelFor(disparity.rows, makeRow, [&](int y, std::vector<float>& agreeing) {
    const auto* left = disparity.ptr<float>(y);
    kernels.keepAgreeing(left, right.ptr<float>(y), width, max_difference, agreeing.data() + kVoteRadiusPx);
    kernels.countAlongRow(left, agreeing.data(), width, max_difference, counts.ptr<std::uint8_t>(y));
  });
  const auto makeVotes = [&] { return RowVotes(disparity, counts, max_difference); };
  parallelFor(disparity.rows, makeVotes, [&](int y, RowVotes& votes) { votes.write(y, kept.ptr<float>(y)); });
  disparity = kept;
}

}  // namespace

void checkLeftRight(cv::Mat& disparity_left, const cv::Mat& disparity_right, const LeftRightCheckParams& params) {
  requireMap(disparity_left, "left-right check");
  requireMap(disparity_right, disparity_left.size(), "left-right check");
  const auto max_difference = static_cast<float>(params.max_difference_px);
  if (params.vote) return keepSupported(disparity_left, disparity_right, max_difference);
  const auto makeRow = [&] { return std::vector<float>(disparity_left.cols); };
  parallelFor(disparity_left.rows, makeRow, [&](int y, std::vector<float>& agreeing) {
    auto* left = disparity_left.ptr<float>(y);
    FDP_STEREO_SELECT(leftRightCheckKernels)
        .keepAgreeing(left, disparity_right.ptr<float>(y), disparity_left.cols, max_difference, agreeing.data());
    std::copy(agreeing.begin(), agreeing.end(), left);
  });
}

}  // namespace fdp_stereo
