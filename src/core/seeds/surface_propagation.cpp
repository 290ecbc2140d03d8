// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seeds/surface_propagation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <omp.h>
#include <Eigen/LU>

#include "images/colour.hpp"
#include "parallel.hpp"
#include "simd/propagation_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr int kRounds = 2;
constexpr float kFar = 1e9F;
constexpr int kCellPx = 2;  // ways are sought on cells of this size
constexpr int kMaxNeighbours = 12;
constexpr int kPhases = 8;         // of the prior between two disparities
constexpr float kFarthest = 4.0F;  // way beyond which a seed has no say
constexpr float kMaxSlope = 1.0F;  // px / px
// Residual at which a neighbour counts a quarter in the plane fit: large at first, so that a steep surface is found,
// and halved from round to round.
constexpr float kFirstFitScalePx = 4.0F;
constexpr float kLastFitScalePx = 0.5F;
constexpr int kFitRounds = 6;
constexpr double kSettled = 0.01;      // px, and px per px, that a round still changes
constexpr double kLevelWeight = 0.5F;  // of a level plane, where the neighbours say little

/// Cost of the step from each pixel to its right (dx = 1) or lower (dy = 1) neighbour.
cv::Mat stepCosts(const cv::Mat& left, int dx, int dy, double gamma, double reach_px) {
  const int channels = left.channels();
  const auto per_px = static_cast<float>(1.0 / reach_px);
  const auto per_level = static_cast<float>(1.0 / gamma);
  cv::Mat costs(left.size(), CV_32FC1, cv::Scalar(0));
#pragma omp parallel for schedule(static)
  for (int y = 0; y < left.rows - dy; ++y) {
    const uchar* here = left.ptr<uchar>(y);
    const uchar* there = left.ptr<uchar>(y + dy) + channels * dx;
    auto* cost = costs.ptr<float>(y);
    for (int x = 0; x < left.cols - dx; ++x) {
      cost[x] = per_px + per_level * colourDistance(here + channels * x, there + channels * x, channels);
    }
  }
  return costs;
}

void sweepRows(GeodesicMap& map) {
  parallelFor(map.distance.rows, [&](int y) {
    auto* distance = map.distance.ptr<float>(y);
    auto* owner = map.owner.ptr<std::int32_t>(y);
    const auto* step = map.across.ptr<float>(y);
    const auto relax = [&](int to, int from, float cost) {
      if (distance[from] + cost < distance[to]) {
        distance[to] = distance[from] + cost;
        owner[to] = owner[from];
      }
    };
    for (int x = 1; x < map.distance.cols; ++x) relax(x, x - 1, step[x - 1]);
    for (int x = map.distance.cols - 2; x >= 0; --x) relax(x, x + 1, step[x]);
  });
}

/// Some columns at a time.
void sweepColumns(GeodesicMap& map) {
  constexpr int kColumns = 64;
  const PropagationKernels& kernels = FDP_STEREO_SELECT(propagationKernels);
  const cv::Size size = map.distance.size();
  const auto sweep = [&](int block) {
    const int x = block * kColumns, count = std::min(kColumns, size.width - x);
    const auto relax = [&](int to, int from, int step) {
      kernels.relaxRow(map.distance.ptr<float>(from) + x, map.owner.ptr<std::int32_t>(from) + x,
                       map.down.ptr<float>(step) + x, count, map.distance.ptr<float>(to) + x,
                       map.owner.ptr<std::int32_t>(to) + x);
    };
    for (int y = 1; y < size.height; ++y) relax(y, y - 1, y - 1);
    for (int y = size.height - 2; y >= 0; --y) relax(y, y + 1, y);
  };
  parallelFor((size.width + kColumns - 1) / kColumns, sweep, 1);
}

/// The seeds whose regions touch that of one seed, each with the shortest way between the two that was met; the
/// nearest of them where there are many.
class Neighbours {
 public:
  struct Entry {
    int seed = -1;
    float way = kFar;
  };

  void meet(int seed, float way) {
    int farthest = 0;
    for (int i = 0; i < count_; ++i) {
      if (entries_[i].seed == seed) {
        entries_[i].way = std::min(entries_[i].way, way);
        return;
      }
      if (entries_[i].way > entries_[farthest].way) farthest = i;
    }
    if (count_ < kMaxNeighbours) {
      entries_[count_++] = {seed, way};
    } else if (way < entries_[farthest].way) {
      entries_[farthest] = {seed, way};
    }
  }
  const Entry* begin() const { return entries_.data(); }
  const Entry* end() const { return entries_.data() + count_; }

 private:
  std::array<Entry, kMaxNeighbours> entries_;
  int count_ = 0;
};

/// Two seeds whose regions touch, and the way between them there.
struct Border {
  int a, b;
  float way;
};

/// By row.
std::vector<std::vector<Border>> findBorders(const GeodesicMap& map) {
  std::vector<std::vector<Border>> borders(map.owner.rows);
  parallelFor(map.owner.rows, [&](int y) {
    const auto meet = [&](int a, int b, float way) {
      if (a >= 0 && b >= 0) borders[y].push_back({a, b, way});
    };
    const int below = std::min(y + 1, map.owner.rows - 1);
    const auto* owner = map.owner.ptr<std::int32_t>(y);
    const auto* owner_below = map.owner.ptr<std::int32_t>(below);
    const auto* distance = map.distance.ptr<float>(y);
    const auto* distance_below = map.distance.ptr<float>(below);
    const auto* across = map.across.ptr<float>(y);
    const auto* down = map.down.ptr<float>(y);
    for (int x = 0; x < map.owner.cols; ++x) {
      const int right = std::min(x + 1, map.owner.cols - 1);
      if (owner[x] != owner[right]) meet(owner[x], owner[right], distance[x] + across[x] + distance[right]);
      if (owner[x] != owner_below[x]) meet(owner[x], owner_below[x], distance[x] + down[x] + distance_below[x]);
    }
  });
  return borders;
}

/// Each thread looks through all borders for those of its seeds.
std::vector<Neighbours> findNeighbours(int seeds, const GeodesicMap& map) {
  const std::vector<std::vector<Border>> borders = findBorders(map);
  std::vector<Neighbours> neighbours(seeds);
  const int parts = omp_get_max_threads(), share = (seeds + parts - 1) / parts;
  const auto meet_all = [&](int part) {
    const auto own = [&](int seed) { return seed / share == part; };
    for (const std::vector<Border>& row : borders) {
      for (const Border& border : row) {
        if (own(border.a)) neighbours[border.a].meet(border.b, border.way);
        if (own(border.b)) neighbours[border.b].meet(border.a, border.way);
      }
    }
  };
  parallelFor(parts, meet_all, 1);
  return neighbours;
}

SeedPlane fitPlane(const Seeds& seeds, int index, const Neighbours& neighbours) {
  using Values = Eigen::Array<float, kMaxNeighbours, 1>;
  const Seed& centre = seeds[index];
  Values x = Values::Zero(), y = Values::Zero(), d = Values::Zero(), nearness = Values::Zero();  // relative to the seed
  int count = 0;
  for (const auto& [other, way] : neighbours) {
    const Seed& seed = seeds[other];
    x(count) = seed.x - centre.x;
    y(count) = seed.y - centre.y;
    d(count) = seed.d - centre.d;
    nearness(count++) = std::exp(-0.5F * way);
  }
  Eigen::Vector3d plane(0.0, 0.0, 0.0);
  float scale = kFirstFitScalePx;
  for (int round = 0; round < kFitRounds; ++round) {
    const Eigen::Vector3f now = plane.cast<float>();
    const Values residual = d - now(0) - now(1) * x - now(2) * y;
    const Values weight = nearness / (1.0F + residual.square() * (0.25F / (scale * scale))).square();
    const Values wx = weight * x, wy = weight * y;
    const double sum_x = wx.sum(), sum_y = wy.sum(), sum_xy = (wx * y).sum();
    Eigen::Matrix3d normal;
    normal << 1.0 + weight.sum(), sum_x, sum_y,  // 1: the seed itself
        sum_x, kLevelWeight + (wx * x).sum(), sum_xy, sum_y, sum_xy, kLevelWeight + (wy * y).sum();
    const Eigen::Vector3d better =
        normal.inverse() * Eigen::Vector3d((weight * d).sum(), (wx * d).sum(), (wy * d).sum());
    const bool settled = round > 1 && (better - plane).cwiseAbs().maxCoeff() < kSettled;
    plane = better;
    if (settled) break;
    scale = std::max(kLastFitScalePx, scale / 2.0F);
  }
  SeedPlane result;
  result.d0 = centre.d + static_cast<float>(plane(0));
  result.slope = plane.tail<2>().cast<float>().cwiseMax(-kMaxSlope).cwiseMin(kMaxSlope);
  return result;
}

/// Raw prior costs by phase: entry kPhases * i + phase belongs to the disparity i - centre - phase / kPhases px off.
template <typename T>
class PriorTable {
 public:
  PriorTable(int count, int max_raw, double spread_px) : centre_(count), length_(2 * count + 2) {
    values_.resize(static_cast<std::size_t>(kPhases) * length_);
    for (int phase = 0; phase < kPhases; ++phase) {
      for (int i = 0; i < length_; ++i) {
        const double off = (i - centre_ - static_cast<double>(phase) / kPhases) / spread_px;
        values_[static_cast<std::size_t>(phase) * length_ + i] =
            static_cast<T>(std::lround(max_raw * (1.0 - std::exp(-0.5 * off * off))));
      }
    }
  }
  /// First entry for a surface at index `at` (0 .. count - 1) of the range.
  const T* at(float at) const {
    const int position = cvRound(at * kPhases);
    return values_.data() + static_cast<std::size_t>(position % kPhases) * length_ + centre_ - position / kPhases;
  }

 private:
  int centre_;
  int length_;
  std::vector<T> values_;
};

template <typename T>
using Blend = void (*)(const T*, int, int, T*);

/// The say of its seed in each cell, 0..255.
cv::Mat sharesOf(const GeodesicMap& map, double strength) {
  cv::Mat shares(map.distance.size(), CV_8UC1);
#pragma omp parallel for schedule(static)
  for (int y = 0; y < shares.rows; ++y) {
    const auto* distance = map.distance.ptr<float>(y);
    auto* share = shares.ptr<uchar>(y);
    for (int x = 0; x < shares.cols; ++x) {
      const double weight = distance[x] < kFarthest ? std::exp(-distance[x]) : 0.0;
      share[x] = static_cast<uchar>(cvRound(255.0 * strength * weight));
    }
  }
  return shares;
}

template <typename T>
double blendSurfaces(const Seeds& seeds, const GeodesicMap& map, const DisparityPropagationParams& params,
                     DisparityAxis axis, Blend<T> blend, CostVolume& volume) {
  const std::vector<SeedPlane> planes = fitPlanes(seeds, map);
  const cv::Mat shares = sharesOf(map, params.strength);
  const PriorTable<T> table(volume.range().count, volume.maxRaw(), params.spread_px * axis.steps);
  const auto last = static_cast<float>(volume.range().count - 1);
  long changed = 0;
#pragma omp parallel for schedule(static) reduction(+ : changed)
  for (int y = 0; y < volume.height(); ++y) {
    const auto* owner = map.owner.ptr<std::int32_t>(y / kCellPx);
    const auto* share = shares.ptr<uchar>(y / kCellPx);
    for (int left = 0; left < volume.width(); left = volume.tileRight(left)) {
      const SearchTiles::Span span = volume.span(y, left);
      const int right = volume.tileRight(left), searched = volume.searched(span);
      T* costs = volume.at<T>(y, left);
      for (int x = left; x < right; ++x, costs += span.count) {
        const int cell = x / kCellPx;
        if (share[cell] == 0) continue;
        const float d = planes[owner[cell]].at(seeds[owner[cell]], x, y);
        const float at = (d - static_cast<float>(axis.min)) * static_cast<float>(axis.steps);
        blend(table.at(std::clamp(at, 0.0F, last)) + span.first, share[cell], searched, costs);
        ++changed;
      }
    }
  }
  return static_cast<double>(changed) / (static_cast<double>(volume.height()) * volume.width());
}

/// Mean colour of each cell, in whole numbers: cv::resize() rounds otherwise on other processors.
cv::Mat cellMeans(const cv::Mat& left) {
  static_assert(kCellPx == 2, "a cell has two rows and columns, of which the border may cut off one");
  const int channels = left.channels();
  cv::Mat cells((left.rows + 1) / 2, (left.cols + 1) / 2, left.type());
  parallelFor(cells.rows, [&](int y) {
    const auto* upper = left.ptr<uchar>(2 * y);
    const auto* lower = left.ptr<uchar>(std::min(2 * y + 1, left.rows - 1));
    auto* mean = cells.ptr<uchar>(y);
    for (int i = 0; i < cells.cols * channels; ++i) {
      const int a = i / channels * 2 * channels + i % channels;
      const int b = a + channels < left.cols * channels ? a + channels : a;
      mean[i] = static_cast<uchar>((upper[a] + upper[b] + lower[a] + lower[b] + 2) / 4);
    }
  });
  return cells;
}

}  // namespace

GeodesicMap spreadSeeds(const Seeds& seeds, const cv::Mat& left, double gamma, double reach_px) {
  const cv::Mat cells = cellMeans(left);
  const cv::Size size = cells.size();
  GeodesicMap map;
  map.distance = cv::Mat(size, CV_32FC1, cv::Scalar(kFar));
  map.owner = cv::Mat(size, CV_32SC1, cv::Scalar(-1));
  for (int i = 0; i < static_cast<int>(seeds.size()); ++i) {
    const int x = cvRound(seeds[i].x);
    const int y = cvRound(seeds[i].y);
    const float start = -std::log(std::clamp(seeds[i].trust, 1e-3F, 1.0F));
    if (x < 0 || y < 0 || x >= left.cols || y >= left.rows) continue;
    if (start >= map.distance.at<float>(y / kCellPx, x / kCellPx)) continue;
    map.distance.at<float>(y / kCellPx, x / kCellPx) = start;
    map.owner.at<std::int32_t>(y / kCellPx, x / kCellPx) = i;
  }
  map.across = stepCosts(cells, 1, 0, gamma, reach_px / kCellPx);
  map.down = stepCosts(cells, 0, 1, gamma, reach_px / kCellPx);
  for (int round = 0; round < kRounds; ++round) {
    sweepColumns(map);
    sweepRows(map);
  }
  return map;
}

std::vector<SeedPlane> fitPlanes(const Seeds& seeds, const GeodesicMap& map) {
  const std::vector<Neighbours> neighbours = findNeighbours(static_cast<int>(seeds.size()), map);
  std::vector<SeedPlane> planes(seeds.size());
#pragma omp parallel for schedule(static)
  for (int i = 0; i < static_cast<int>(seeds.size()); ++i) planes[i] = fitPlane(seeds, i, neighbours[i]);
  return planes;
}

double propagateSurfaces(const Seeds& seeds, const cv::Mat& left, const DisparityPropagationParams& params,
                         DisparityAxis axis, CostVolume& volume) {
  const GeodesicMap map = spreadSeeds(seeds, left, params.gamma, params.reach_px);
  const PropagationKernels& kernels = FDP_STEREO_SELECT(propagationKernels);
  return volume.depth() == CostVolume::Depth::kU8
             ? blendSurfaces<std::uint8_t>(seeds, map, params, axis, kernels.blend8, volume)
             : blendSurfaces<std::uint16_t>(seeds, map, params, axis, kernels.blend16, volume);
}

}  // namespace fdp_stereo
