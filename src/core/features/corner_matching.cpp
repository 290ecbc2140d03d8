// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "features/corner_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/feature_matching.hpp"
#include "parallel.hpp"

namespace fdp_stereo {
namespace {

constexpr int kFastThreshold = 7;  // grey levels
constexpr int kCellPx = 24;        // corners are spread over cells of this size
constexpr int kPatchRadius = 8;    // px, of the code
constexpr int kCodeWords = 4;
/// Codes that differ in more bits are not of one point, whatever the ratio says.
constexpr int kMaxDistance = 80;

using Code = std::array<std::uint64_t, kCodeWords>;
struct Comparison {
  cv::Point first, second;
};

int distance(const Code& a, const Code& b) {
  int bits = 0;
  for (int k = 0; k < kCodeWords; ++k) bits += __builtin_popcountll(a[k] ^ b[k]);
  return bits;
}

/// 256 fixed pairs of pixels, drawn with a density that falls off towards the border of the patch.
std::vector<Comparison> makePattern() {
  std::uint32_t state = 20260101;
  const auto draw = [&state] {  // sum of two uniform draws; the same numbers everywhere
    int sum = 0;
    for (int i = 0; i < 2; ++i) {
      state = state * 1664525U + 1013904223U;
      sum += static_cast<int>((state >> 16U) % (kPatchRadius + 1));
    }
    return sum - kPatchRadius;
  };
  std::vector<Comparison> pattern;
  while (pattern.size() < 64U * kCodeWords) {
    Comparison pair;
    pair.first = {draw(), draw()};
    pair.second = {draw(), draw()};
    if (pair.first != pair.second) pattern.push_back(pair);
  }
  return pattern;
}

struct Corners {
  std::vector<cv::Point> points;  // sorted by (y, x)
  std::vector<Code> codes;
  std::vector<int> row_begin;  // first index of each row; one more entry than rows
};

bool stronger(const cv::KeyPoint* a, const cv::KeyPoint* b) { return a->response > b->response; }

/// As cv::FAST(), some rows at a time.
std::vector<cv::KeyPoint> findKeypoints(const cv::Mat& grey) {
  constexpr int kRows = 64;
  constexpr int kReach = 4;  // rows beside that decide: the ring, and that of the neighbour with which it competes
  std::vector<std::vector<cv::KeyPoint>> bands((grey.rows + kRows - 1) / kRows);
  const auto find = [&](int band) {
    const int first = band * kRows, last = std::min(first + kRows, grey.rows);
    const int top = std::max(0, first - kReach);
    std::vector<cv::KeyPoint> found;
    cv::FAST(grey.rowRange(top, std::min(last + kReach, grey.rows)), found, kFastThreshold, true);
    for (cv::KeyPoint& point : found) {
      point.pt.y += static_cast<float>(top);
      if (point.pt.y >= static_cast<float>(first) && point.pt.y < static_cast<float>(last))
        bands[band].push_back(point);
    }
  };
  parallelFor(static_cast<int>(bands.size()), find, 1);
  std::vector<cv::KeyPoint> keypoints;
  for (const auto& band : bands) keypoints.insert(keypoints.end(), band.begin(), band.end());
  return keypoints;
}

/// The strongest corners of each cell, and of those the strongest `max_features`, sorted by (y, x).
std::vector<cv::Point> findCorners(const cv::Mat& grey, int max_features) {
  const std::vector<cv::KeyPoint> keypoints = findKeypoints(grey);
  const int columns = (grey.cols + kCellPx - 1) / kCellPx;
  const int rows = (grey.rows + kCellPx - 1) / kCellPx;
  std::vector<std::vector<const cv::KeyPoint*>> cells(static_cast<std::size_t>(columns) * rows);
  for (const cv::KeyPoint& k : keypoints) {
    const auto x = static_cast<int>(k.pt.x);
    const auto y = static_cast<int>(k.pt.y);
    const bool inside =
        x >= kPatchRadius && y >= kPatchRadius && x < grey.cols - kPatchRadius && y < grey.rows - kPatchRadius;
    if (inside) cells[static_cast<std::size_t>(y / kCellPx) * columns + x / kCellPx].push_back(&k);
  }
  const std::size_t per_cell = std::max<std::size_t>(1, max_features / cells.size());
  std::vector<const cv::KeyPoint*> kept;
  for (auto& cell : cells) {
    if (cell.size() > per_cell) {
      std::stable_sort(cell.begin(), cell.end(), stronger);
      cell.resize(per_cell);
    }
    kept.insert(kept.end(), cell.begin(), cell.end());
  }
  if (kept.size() > static_cast<std::size_t>(max_features)) {
    std::stable_sort(kept.begin(), kept.end(), stronger);
    kept.resize(max_features);
  }
  std::vector<cv::Point> points;
  points.reserve(kept.size());
  for (const cv::KeyPoint* k : kept) points.emplace_back(k->pt);
  std::sort(points.begin(), points.end(),
            [](cv::Point a, cv::Point b) { return std::make_pair(a.y, a.x) < std::make_pair(b.y, b.x); });
  return points;
}

Corners describe(const cv::Mat& grey, int max_features) {
  static const std::vector<Comparison> pattern = makePattern();
  Corners corners;
  corners.points = findCorners(grey, max_features);
  corners.codes.resize(corners.points.size());
  cv::Mat smooth;
  cv::blur(grey, smooth, {3, 3});
  const auto step = static_cast<std::ptrdiff_t>(smooth.step);
  std::array<std::pair<std::ptrdiff_t, std::ptrdiff_t>, 64U * kCodeWords> offsets;
  for (std::size_t b = 0; b < pattern.size(); ++b) {
    offsets[b] = {pattern[b].first.y * step + pattern[b].first.x, pattern[b].second.y * step + pattern[b].second.x};
  }
  parallelFor(static_cast<int>(corners.points.size()), [&](int i) {
    const uchar* centre = smooth.ptr<uchar>(corners.points[i].y) + corners.points[i].x;
    for (int w = 0; w < kCodeWords; ++w) {
      std::uint64_t word = 0;
      for (int b = 0; b < 64; ++b) {
        const auto& pair = offsets[64 * w + b];
        word |= static_cast<std::uint64_t>(centre[pair.first] < centre[pair.second]) << b;
      }
      corners.codes[i][w] = word;
    }
  });
  corners.row_begin.assign(grey.rows + 1, 0);
  for (const cv::Point& p : corners.points) ++corners.row_begin[p.y + 1];
  for (int y = 0; y < grey.rows; ++y) corners.row_begin[y + 1] += corners.row_begin[y];
  return corners;
}

/// Best and second best partner of one corner, and the best partner of each corner it was compared with.
struct Best {
  int index = -1;
  int distance = 64 * kCodeWords + 1;
  int second = 64 * kCodeWords + 1;

  void offer(int candidate, int d) {
    if (d < distance) {
      second = distance;
      distance = d;
      index = candidate;
    } else {
      second = std::min(second, d);
    }
  }
};

}  // namespace

std::vector<CornerMatch> matchCorners(const cv::Mat& left_grey, const cv::Mat& right_grey, DisparityRange range,
                                      const FeatureMatchingParams& params) {
  const Corners left = describe(left_grey, params.max_features);
  const Corners right = describe(right_grey, params.max_features);
  const int band =
      static_cast<int>(std::ceil(params.max_row_difference_px)) + 1;  // a corner is within 1 px of its point
  std::vector<Best> of_left(left.points.size());
  std::vector<Best> of_right(right.points.size());
  for (int i = 0; i < static_cast<int>(left.points.size()); ++i) {
    const cv::Point p = left.points[i];
    for (int y = std::max(0, p.y - band); y <= std::min(right_grey.rows - 1, p.y + band); ++y) {
      for (int j = right.row_begin[y]; j < right.row_begin[y + 1]; ++j) {
        const int d = p.x - right.points[j].x;
        if (d < range.min - 1 || d > range.max() + 1) continue;
        const int bits = distance(left.codes[i], right.codes[j]);
        of_left[i].offer(j, bits);
        of_right[j].offer(i, bits);
      }
    }
  }
  std::vector<CornerMatch> matches;
  for (int i = 0; i < static_cast<int>(left.points.size()); ++i) {
    const Best& best = of_left[i];
    if (best.index < 0 || best.distance > kMaxDistance) continue;
    const float ratio = static_cast<float>(best.distance) / static_cast<float>(std::max(1, best.second));
    if (ratio > static_cast<float>(params.max_ratio)) continue;
    if (params.mutual_check && of_right[best.index].index != i) continue;
    matches.push_back({left.points[i], right.points[best.index], ratio});
  }
  return matches;
}

}  // namespace fdp_stereo
