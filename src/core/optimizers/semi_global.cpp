// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/semi_global.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <omp.h>

#include "fdp_stereo/buffer.hpp"
#include "fdp_stereo/cost_scale.hpp"
#include "optimizers/disparity_selection.hpp"
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace {

/// The rows of an image that take part: every step-th one.
struct RowGrid {
  int step = 1;
  int first = 0;
  int count = 0;

  RowGrid(int height, int row_step) : step(row_step), first(std::min(row_step / 2, height - 1)) {
    count = (height - 1 - first) / step + 1;
  }
  int imageRow(int row) const { return first + row * step; }
};

/// Penalties in raw units; P2 by the grey difference between two pixels.
template <typename T>
struct Penalties {
  T p1;
  std::array<T, 256> p2;

  Penalties(const SemiGlobalParams& params, float step) : p1(static_cast<T>(std::lround(params.p1 / step))) {
    for (int difference = 0; difference < 256; ++difference) {
      const double jump = std::max(params.p1, params.p2 / (1.0 + params.p2_gradient * difference));
      p2[difference] = static_cast<T>(std::lround(jump / step));
    }
  }
};

void follow(const PathBundle<std::uint8_t>& bundle, int lines, PathSum sum) {
  FDP_STEREO_SELECT(semiGlobalKernels).followU8(bundle, lines, sum);
}
void follow(const PathBundle<std::uint16_t>& bundle, int lines, PathSum sum) {
  FDP_STEREO_SELECT(semiGlobalKernels).followU16(bundle, lines, sum);
}

/// Memory of one run; kept from pair to pair.
struct PathMemory {
  Buffer excess;    // of three paths: rows x width x stride
  Buffer totals;    // u16, of a few rows: chunk x width x stride
  Buffer across;    // P2 between (x - 1, y) and (x, y): rows x (width + 1)
  Buffer down;      // P2 between (x, y - 1) and (x, y): (rows + 1) x width
  Buffer columns;   // two slots per column
  Buffer smallest;  // per column
  Buffer along;     // per thread two slots per row of a bundle
};

/// The paths of one run. Rows are independent of each other along rows, columns along columns, so that the threads
/// share both; a few rows at a time go down and up again while they are in the cache.
template <typename T>
class Paths {
 public:
  Paths(const CostVolume& volume, const RowGrid& rows, const cv::Mat& guide, const Penalties<T>& penalties, int threads,
        int chunk, PathMemory& memory)
      : volume_(volume),
        rows_(rows),
        guide_(guide),
        penalties_(penalties),
        width_(volume.width()),
        count_(volume.stride()),
        slot_(static_cast<std::size_t>(count_) + 2 * kGuard),
        memory_(memory) {
    const std::size_t pixels = static_cast<std::size_t>(width_) * rows.count;
    memory.excess.reserve(pixels * count_ * sizeof(T));
    memory.totals.reserve((static_cast<std::size_t>(chunk) * rowEntries() + kSumsRead) * sizeof(std::uint16_t));
    memory.across.reserve((pixels + rows.count) * sizeof(T));
    memory.down.reserve((pixels + width_) * sizeof(T));
    memory.columns.reserve(2 * width_ * slot_ * sizeof(T));
    memory.smallest.reserve((static_cast<std::size_t>(width_) + kBundleLines) * sizeof(T));
    memory.along.reserve(2 * slot_ * kBundleLines * threads * sizeof(T));
  }

  /// Of the row-th row of a chunk.
  std::uint16_t* totals(int row) { return memory_.totals.as<std::uint16_t>() + row * rowEntries(); }

  /// Both ways along up to kBundleLines rows from `first` on; begins their sums.
  void alongRows(int first, int last, int thread) {
    for (int row = first; row < last; ++row) fillPenalties(row);
    const int lines = last - first == kBundleLines ? kBundleLines : 1;
    for (int row = first; row < last; row += lines) {
      for (const bool backwards : {false, true}) followRows(row, lines, backwards, thread);
    }
  }

  /// Forgets the predecessors of the columns in [first, last): they cost nothing.
  void startColumns(int first, int last) {
    for (int x = first; x < last; ++x) {
      clear(column(x, 0));
      clear(column(x, 1));
      memory_.smallest.as<T>()[x] = 0;
    }
  }

  /// Along the columns in [first, last) through the rows in [top, bottom), which follow those of the call before.
  /// Upwards, the last way, gives the totals of these rows.
  void alongColumns(int first, int last, int top, int bottom, bool upwards, bool exchanged) {
    const int lines = last - first == kBundleLines ? kBundleLines : 1;
    PathBundle<T> bundle = emptyBundle();
    bundle.length = bottom - top;
    bundle.step = upwards ? -rows_.step * volumeRow() : rows_.step * volumeRow();
    bundle.p2_step = upwards ? -width_ : width_;
    const int start = upwards ? bottom - 1 : top;
    for (int x = first; x < last; x += lines) {
      for (int k = 0; k < lines; ++k) {
        const std::ptrdiff_t pixel = static_cast<std::ptrdiff_t>(x + k) * count_;
        bundle.costs[k] = volume_.at<T>(rows_.imageRow(start), 0) + pixel;
        bundle.excess[k] = excess(start) + pixel;
        bundle.totals[k] = totals(start - top) + pixel;
        bundle.p2[k] = memory_.down.as<T>() + static_cast<std::ptrdiff_t>(upwards ? start + 1 : start) * width_ + x + k;
        bundle.before[k] = column(x + k, exchanged ? 1 : 0);
        bundle.after[k] = column(x + k, exchanged ? 0 : 1);
      }
      bundle.smallest = memory_.smallest.as<T>() + x;
      bundle.sums_step = upwards ? -rowEntries() : rowEntries();
      follow(bundle, lines, upwards ? PathSum::kLast : PathSum::kNext);
    }
  }

 private:
  static constexpr std::size_t kGuard = CostVolume::kPadding;

  std::ptrdiff_t rowEntries() const { return static_cast<std::ptrdiff_t>(width_) * count_; }
  std::ptrdiff_t volumeRow() const { return rowEntries(); }
  T* excess(int row) { return memory_.excess.as<T>() + row * rowEntries(); }
  T* column(int x, int slot) {
    return memory_.columns.as<T>() + (2 * static_cast<std::size_t>(x) + slot) * slot_ + kGuard;
  }

  PathBundle<T> emptyBundle() const {
    PathBundle<T> bundle{};
    bundle.count = count_;
    bundle.p1 = penalties_.p1;
    return bundle;
  }

  /// A slot of a predecessor outside the image, with guards that stay the largest after P1 is added.
  void clear(T* slot) const {
    const auto guard = static_cast<T>(static_cast<T>(~T{0}) - penalties_.p1);
    std::fill(slot - kGuard, slot, guard);
    std::fill(slot, slot + count_, T{0});
    std::fill(slot + count_, slot + count_ + kGuard, guard);
  }

  void fillPenalties(int row) {
    const auto* here = guide_.ptr<std::uint8_t>(rows_.imageRow(row));
    const auto* above = guide_.ptr<std::uint8_t>(rows_.imageRow(std::max(row - 1, 0)));
    T* across = memory_.across.as<T>() + static_cast<std::ptrdiff_t>(row) * (width_ + 1);
    T* down = memory_.down.as<T>() + static_cast<std::ptrdiff_t>(row) * width_;
    across[0] = across[width_] = 0;
    for (int x = 1; x < width_; ++x) across[x] = penalties_.p2[std::abs(here[x] - here[x - 1])];
    for (int x = 0; x < width_; ++x) down[x] = penalties_.p2[std::abs(here[x] - above[x])];
    if (row + 1 == rows_.count) std::fill(down + width_, down + 2 * width_, T{0});
  }

  void followRows(int row, int lines, bool backwards, int thread) {
    T smallest[kBundleLines] = {};
    PathBundle<T> bundle = emptyBundle();
    bundle.length = width_;
    bundle.step = bundle.sums_step = backwards ? -count_ : count_;
    bundle.p2_step = backwards ? -1 : 1;
    bundle.smallest = smallest;
    const int start = backwards ? width_ - 1 : 0;
    T* slots = memory_.along.as<T>() + 2 * slot_ * kBundleLines * thread + kGuard;
    for (int k = 0; k < lines; ++k) {
      const std::ptrdiff_t pixel = static_cast<std::ptrdiff_t>(start) * count_;
      bundle.costs[k] = volume_.at<T>(rows_.imageRow(row + k), 0) + pixel;
      bundle.excess[k] = excess(row + k) + pixel;
      bundle.p2[k] =
          memory_.across.as<T>() + static_cast<std::ptrdiff_t>(row + k) * (width_ + 1) + (backwards ? width_ : 0);
      bundle.before[k] = slots + 2 * k * slot_;
      bundle.after[k] = slots + (2 * k + 1) * slot_;
      clear(bundle.before[k]);
      clear(bundle.after[k]);
    }
    follow(bundle, lines, backwards ? PathSum::kNext : PathSum::kFirst);
  }

  const CostVolume& volume_;
  const RowGrid rows_;
  const cv::Mat& guide_;
  const Penalties<T>& penalties_;
  const int width_;
  const int count_;
  const std::size_t slot_;
  PathMemory& memory_;
};

void check(const CostVolume& volume, const cv::Mat& guide, const SemiGlobalParams& params) {
  if (guide.type() != CV_8UC1 || guide.rows != volume.height() || guide.cols != volume.width()) {
    throw std::invalid_argument("semi-global matching: the guide must be an 8-bit grey image of " +
                                std::to_string(volume.width()) + " x " + std::to_string(volume.height()) + " px");
  }
  const double largest = volume.maxRaw() + penaltiesOf(params) / volume.step() + 2;
  const double allowed = largestPathCost(volume.depth());
  if (largest > allowed) {
    throw std::invalid_argument("semi-global matching: cost, P1 and P2 need " + std::to_string(largest) +
                                " steps of the volume, but only " + std::to_string(allowed) + " fit");
  }
}

}  // namespace

double penaltiesOf(const SemiGlobalParams& params) { return params.p1 + params.p2; }

struct SemiGlobalMatcher::Workspace {
  PathMemory memory;
  std::vector<DisparitySelection> selections;  // per thread

  template <typename T>
  void run(const CostVolume& volume, const cv::Mat& guide, const SemiGlobalParams& params, const RowGrid& rows,
           OptimizerOutput& output);
};

/// Down the image: what the paths along the rows and downwards add; up again: the totals, and the winners.
template <typename T>
void SemiGlobalMatcher::Workspace::run(const CostVolume& volume, const cv::Mat& guide, const SemiGlobalParams& params,
                                       const RowGrid& rows, OptimizerOutput& output) {
  const int threads = omp_get_max_threads();
  const Penalties<T> penalties(params, volume.step());
  const int width = volume.width(), chunk = kBundleLines * threads;
  Paths<T> paths(volume, rows, guide, penalties, threads, chunk, memory);
  DisparitySelection::createMaps(rows.count, volume.width(), output);
  selections.clear();
  for (int i = 0; i < threads; ++i) selections.emplace_back(volume, params.subpixel, params.uniqueness_ratio, 4);
  const int columns = (width + kBundleLines - 1) / kBundleLines;
#pragma omp parallel num_threads(threads)
  {
#pragma omp for schedule(static)
    for (int i = 0; i < columns; ++i) paths.startColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width));
    for (int top = 0; top < rows.count; top += chunk) {
      const int bottom = std::min(top + chunk, rows.count);
#pragma omp for schedule(static)
      for (int row = top; row < bottom; row += kBundleLines) {
        paths.alongRows(row, std::min(row + kBundleLines, bottom), omp_get_thread_num());
      }
#pragma omp for schedule(static)
      for (int i = 0; i < columns; ++i) {
        paths.alongColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width), top, bottom, false, top % 2 != 0);
      }
    }
#pragma omp for schedule(static)
    for (int i = 0; i < columns; ++i) paths.startColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width));
    for (int bottom = rows.count; bottom > 0; bottom -= chunk) {
      const int top = std::max(bottom - chunk, 0);
      const bool exchanged = (rows.count - bottom) % 2 != 0;
#pragma omp for schedule(static)
      for (int i = 0; i < columns; ++i) {
        paths.alongColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width), top, bottom, true, exchanged);
      }
#pragma omp for schedule(static)
      for (int row = top; row < bottom; ++row) {
        selections[omp_get_thread_num()].selectRow(row, paths.totals(row - top), output);
      }
    }
  }
}

SemiGlobalMatcher::SemiGlobalMatcher() : workspace_(std::make_unique<Workspace>()) {}
SemiGlobalMatcher::~SemiGlobalMatcher() = default;
SemiGlobalMatcher::SemiGlobalMatcher(SemiGlobalMatcher&&) noexcept = default;
SemiGlobalMatcher& SemiGlobalMatcher::operator=(SemiGlobalMatcher&&) noexcept = default;

void SemiGlobalMatcher::match(const CostVolume& volume, const cv::Mat& guide, const SemiGlobalParams& params,
                              OptimizerOutput& output, int row_step) {
  check(volume, guide, params);
  const RowGrid rows(volume.height(), row_step);
  if (volume.depth() == CostVolume::Depth::kU8) {
    workspace_->run<std::uint8_t>(volume, guide, params, rows, output);
  } else {
    workspace_->run<std::uint16_t>(volume, guide, params, rows, output);
  }
}

int SemiGlobalMatcher::firstRow(int height, int row_step) { return RowGrid(height, row_step).imageRow(0); }

}  // namespace fdp_stereo
