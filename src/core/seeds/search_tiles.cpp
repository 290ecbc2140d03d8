// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seeds/search_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "row_grid.hpp"

namespace fdp_stereo {
namespace {

constexpr int kVotes = 4;              // winners that differ by no more than 1 px
constexpr int kMargin = 2;             // px beyond what was found
constexpr double kLargestShare = 0.6;  // of the cells, with which tiles still pay

/// Indices of disparities from the first to the last one.
struct Interval {
  int first = std::numeric_limits<int>::max();
  int last = -1;

  void add(const Interval& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
  void add(int index) { add(Interval{index, index}); }
};

/// What was found, tile by tile.
class Findings {
 public:
  Findings(cv::Size size, DisparityRange range)
      : across_(SearchTiles::across(size.width)),
        range_(range),
        votes_(static_cast<std::size_t>(across_) * range.count),
        winners_(static_cast<std::size_t>(across_) * SearchTiles::down(size.height)),
        known_(winners_.size()) {}

  /// The rows of a row of tiles.
  void addRows(const RoughDisparity& rough, int first, int last, int tile_row) {
    std::fill(votes_.begin(), votes_.end(), 0);
    for (int row = first; row < last; ++row) {
      for (int x = 0; x < rough.winners.cols; ++x) {
        const float winner = rough.winners.at<float>(row, x), known = rough.known.at<float>(row, x);
        const int column = x >> SearchTiles::kColumnShift;
        if (!std::isnan(winner)) ++votes_[static_cast<std::size_t>(column) * range_.count + indexOf(winner)];
        if (!std::isnan(known)) known_[tile_row * across_ + column].add(indexOf(known));
      }
    }
    for (int column = 0; column < across_; ++column) {
      count(&votes_[static_cast<std::size_t>(column) * range_.count], winners_[tile_row * across_ + column]);
    }
  }

  void add(const Seeds& seeds, cv::Size size) {
    for (const Seed& seed : seeds) {
      const int x = cvRound(seed.x), y = cvRound(seed.y);
      if (x < 0 || y < 0 || x >= size.width || y >= size.height || !std::isfinite(seed.d)) continue;
      known_[(y >> SearchTiles::kRowShift) * across_ + (x >> SearchTiles::kColumnShift)].add(indexOf(seed.d));
    }
  }

  Interval around(int row, int column) const {
    Interval all = winners_[row * across_ + column];
    const int down = static_cast<int>(known_.size()) / across_;
    for (int r = std::max(0, row - 1); r <= std::min(down - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(across_ - 1, column + 1); ++c)
        all.add(known_[r * across_ + c]);
    }
    return all;
  }

 private:
  int indexOf(float d) const { return std::clamp(cvRound(d) - range_.min, 0, range_.count - 1); }

  void count(const int* votes, Interval& found) const {
    for (int i = 0; i < range_.count; ++i) {
      const int alike = votes[i] + (i > 0 ? votes[i - 1] : 0) + (i + 1 < range_.count ? votes[i + 1] : 0);
      if (votes[i] > 0 && alike >= kVotes) found.add(i);
    }
  }

  int across_;
  DisparityRange range_;
  std::vector<int> votes_;         // of a row of tiles, [column][index]
  std::vector<Interval> winners_;  // by tile
  std::vector<Interval> known_;
};

int rounded(int count) { return (count + CostVolume::kPadding - 1) / CostVolume::kPadding * CostVolume::kPadding; }

/// All disparities where nothing was found.
SearchTiles::Span spanOf(const Interval& found, DisparityRange range) {
  if (found.last < 0) return {0, rounded(range.count)};
  const int wanted = found.last - found.first + 1 + 2 * kMargin;
  const int count = std::min(rounded(wanted), rounded(range.count));
  const int first = found.first - kMargin - (count - wanted) / 2;
  return {std::clamp(first, 0, std::max(0, range.count - count)), count};
}

}  // namespace

SearchTiles findSearchTiles(const RoughDisparity& rough, const Seeds& seeds, cv::Size size, DisparityRange range,
                            int row_step) {
  const RowGrid rows(size.height, row_step);
  const auto firstFrom = [&](int y) {
    return std::min((std::max(0, y - rows.first) + row_step - 1) / row_step, rows.count);
  };
  Findings findings(size, range);
  findings.add(seeds, size);
  SearchTiles tiles;
  double cells = 0.0;
  const int down = SearchTiles::down(size.height), across = SearchTiles::across(size.width);
  for (int row = 0; row < down; ++row) {
    findings.addRows(rough, firstFrom(row * SearchTiles::kRows), firstFrom((row + 1) * SearchTiles::kRows), row);
  }
  for (int row = 0; row < down; ++row) {
    for (int column = 0; column < across; ++column) {
      tiles.spans.push_back(spanOf(findings.around(row, column), range));
      cells += tiles.spans.back().count;
    }
  }
  if (cells > kLargestShare * rounded(range.count) * down * across) return {};
  return tiles;
}

}  // namespace fdp_stereo
