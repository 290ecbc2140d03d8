// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seeds/seed_grid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace fdp_stereo {
namespace {

constexpr double kSeedsPerCell = 3.0;
constexpr int kRings = 2;
/// Of seeds read in a cell: where they lie much denser than on average, the first ones have to do.
constexpr int kMaxPerCell = 24;

}  // namespace

SeedGrid::SeedGrid(const Seeds& seeds, cv::Size image) : seeds_(seeds) {
  const double area = static_cast<double>(image.area());
  cell_px_ = static_cast<float>(
      std::max(1.0, std::sqrt(area * kSeedsPerCell / std::max(1.0, static_cast<double>(seeds.size())))));
  columns_ = static_cast<int>(static_cast<float>(image.width) / cell_px_) + 1;
  rows_ = static_cast<int>(static_cast<float>(image.height) / cell_px_) + 1;
  begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  std::vector<int> cells;
  for (const Seed& s : seeds) {
    cells.push_back(cellOf(s.y, rows_) * columns_ + cellOf(s.x, columns_));
    ++begin_[cells.back() + 1];
  }
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  order_.resize(seeds.size());
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  for (int i = 0; i < static_cast<int>(seeds.size()); ++i) order_[next[cells[i]]++] = i;
}

int SeedGrid::cellOf(float position, int cells) const {
  return std::clamp(static_cast<int>(position / cell_px_), 0, cells - 1);
}

std::vector<SeedGrid::Neighbour> SeedGrid::nearest(int seed, int count) const {
  const Seed& centre = seeds_[seed];
  const int column = cellOf(centre.x, columns_);
  const int row = cellOf(centre.y, rows_);
  std::vector<Neighbour> found;
  for (int r = std::max(0, row - kRings); r <= std::min(rows_ - 1, row + kRings); ++r) {
    for (int c = std::max(0, column - kRings); c <= std::min(columns_ - 1, column + kRings); ++c) {
      const int cell = r * columns_ + c;
      const int end = std::min(begin_[cell + 1], begin_[cell] + kMaxPerCell);
      for (int k = begin_[cell]; k < end; ++k) {
        const Seed& other = seeds_[order_[k]];
        if (order_[k] != seed) found.push_back({order_[k], std::hypot(other.x - centre.x, other.y - centre.y)});
      }
    }
  }
  const auto nearer = [](const Neighbour& a, const Neighbour& b) {
    return std::tie(a.distance_px, a.index) < std::tie(b.distance_px, b.index);
  };
  const std::size_t kept = std::min<std::size_t>(count, found.size());
  std::partial_sort(found.begin(), found.begin() + kept, found.end(), nearer);
  found.resize(kept);
  return found;
}

}  // namespace fdp_stereo
