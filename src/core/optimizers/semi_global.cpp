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
#include "row_grid.hpp"
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace {

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
  Buffer excess;    // of three paths, laid out as the volume
  Buffer totals;    // u16, of a few rows
  Buffer across;    // P2 between (x - 1, y) and (x, y): rows x (width + 1)
  Buffer down;      // P2 between (x, y - 1) and (x, y): (rows + 1) x width
  Buffer columns;   // two slots per column
  Buffer smallest;  // per column
  Buffer along;     // per thread two slots per row of a bundle
};

/// The paths of one run. Rows are independent of each other along rows, columns along columns, so that the threads
/// share both; a few rows at a time go down and up again while they are in the cache. A path goes tile by tile; what
/// the tile before did not search costs a jump.
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
        slot_(static_cast<std::size_t>(volume.stride()) + 2 * kGuard),
        memory_(memory) {
    const std::size_t pixels = static_cast<std::size_t>(width_) * rows.count;
    for (int top = 0; top < rows.count; top = volume.tileBottom(top)) {
      longest_row_ = std::max(longest_row_, volume.rowEntries(top));
    }
    memory.excess.reserve((volume.offset(rows.count - 1, 0) + longest_row_) * sizeof(T));
    memory.totals.reserve((chunk * longest_row_ + kSumsRead) * sizeof(std::uint16_t));
    memory.across.reserve((pixels + rows.count) * sizeof(T));
    memory.down.reserve((pixels + width_) * sizeof(T));
    memory.columns.reserve(2 * width_ * slot_ * sizeof(T));
    memory.smallest.reserve((static_cast<std::size_t>(width_) + kBundleLines) * sizeof(T));
    memory.along.reserve(2 * slot_ * kBundleLines * threads * sizeof(T));
  }

  /// Of a pixel of a chunk that begins with row `top`.
  std::uint16_t* totals(int top, int row, int x) {
    return memory_.totals.as<std::uint16_t>() + (volume_.offset(row, x) - volume_.offset(top, 0));
  }

  /// Both ways along up to kBundleLines rows from `first` on; begins their sums.
  void alongRows(int first, int last, int thread) {
    for (int row = first; row < last; ++row) fillPenalties(row);
    const int lines = last - first == kBundleLines ? kBundleLines : 1;
    for (int row = first; row < last; row += lines) {
      for (const bool backwards : {false, true}) followRows(row, lines, backwards, thread);
    }
  }

  /// Forgets the predecessors of the columns in [first, last) at a row: they cost nothing.
  void startColumns(int first, int last, int row) {
    for (int x = first; x < last; ++x) {
      const int count = volume_.span(row, x).count;
      clear(column(x, 0), count);
      clear(column(x, 1), count);
      memory_.smallest.as<T>()[x] = 0;
    }
  }

  /// Along the columns in [first, last) through the rows in [top, bottom), which follow those of the call before.
  /// Upwards, the last way, gives the totals of these rows.
  void alongColumns(int first, int last, int top, int bottom, bool upwards, bool exchanged) {
    const int lines = last - first == kBundleLines ? kBundleLines : 1;
    for (int x = first; x < last; x += lines) {
      bool other = exchanged;
      for (int done = 0; done < bottom - top;) {
        const int start = upwards ? bottom - 1 - done : top + done;
        const int end = upwards ? std::max(top, volume_.tileTop(start)) : std::min(bottom, volume_.tileBottom(start));
        const int length = upwards ? start + 1 - end : end - start;
        followColumns(x, lines, start, length, top, upwards, other);
        other ^= length % 2 != 0;
        done += length;
      }
    }
  }

 private:
  static constexpr std::size_t kGuard = CostVolume::kPadding;

  T* excess(int row, int x) { return memory_.excess.as<T>() + volume_.offset(row, x); }
  T* column(int x, int slot) {
    return memory_.columns.as<T>() + (2 * static_cast<std::size_t>(x) + slot) * slot_ + kGuard;
  }

  PathBundle<T> bundleOf(int count) const {
    PathBundle<T> bundle{};
    bundle.count = count;
    bundle.p1 = penalties_.p1;
    return bundle;
  }

  /// Stays the largest after P1 is added.
  T largest() const { return static_cast<T>(static_cast<T>(~T{0}) - penalties_.p1); }

  /// A slot of a predecessor outside the image.
  void clear(T* slot, int count) const {
    std::fill(slot - kGuard, slot, largest());
    std::fill(slot, slot + count, T{0});
    std::fill(slot + count, slot + count + kGuard, largest());
  }

  /// The slots of a path that leaves one span for another: what was not searched costs a jump from the best there.
  void carryOver(SearchTiles::Span from, SearchTiles::Span to, int k, const PathBundle<T>& bundle) const {
    if (from.first == to.first && from.count == to.count) return;
    T* const old = bundle.before[k] - from.first;  // both by the index of the disparity
    T* const now = bundle.after[k] - to.first;
    const int first = std::max(from.first, to.first);
    const int last = std::max(first, std::min(from.first + from.count, to.first + to.count));
    T smallest = static_cast<T>(bundle.smallest[k] + *bundle.p2[k]);
    const T jump = smallest;
    for (int i = first; i < last; ++i) smallest = std::min(smallest, old[i]);
    clear(bundle.after[k], to.count);
    std::fill(now + to.first, now + to.first + to.count, static_cast<T>(jump - smallest));
    for (int i = first; i < last; ++i) now[i] = static_cast<T>(std::min(old[i], jump) - smallest);
    std::copy(bundle.after[k] - kGuard, bundle.after[k] + to.count + kGuard, bundle.before[k] - kGuard);
    bundle.smallest[k] = 0;
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
    T* slots = memory_.along.as<T>() + 2 * slot_ * kBundleLines * thread + kGuard;
    int x = backwards ? width_ - 1 : 0;
    for (int k = 0; k < 2 * lines; ++k) clear(slots + k * slot_, volume_.span(row, x).count);
    bool exchanged = false;
    for (int done = 0; done < width_;) {
      const int length = backwards ? x + 1 - volume_.tileLeft(x) : volume_.tileRight(x) - x;
      followRowTile(row, lines, x, length, backwards, slots, exchanged, smallest);
      exchanged ^= length % 2 != 0;
      done += length;
      x = backwards ? x - length : x + length;
    }
  }

  /// `length` pixels of one tile from column x on.
  void followRowTile(int row, int lines, int x, int length, bool backwards, T* slots, bool exchanged, T* smallest) {
    const int before = backwards ? x + 1 : x - 1;
    const SearchTiles::Span span = volume_.span(row, x);
    PathBundle<T> bundle = bundleOf(span.count);
    bundle.length = length;
    bundle.step = bundle.sums_step = backwards ? -span.count : span.count;
    bundle.p2_step = backwards ? -1 : 1;
    bundle.smallest = smallest;
    for (int k = 0; k < lines; ++k) {
      bundle.costs[k] = volume_.at<T>(rows_.imageRow(row + k), x);
      bundle.excess[k] = excess(row + k, x);
      bundle.p2[k] = memory_.across.as<T>() + static_cast<std::ptrdiff_t>(row + k) * (width_ + 1) + x + backwards;
      bundle.before[k] = slots + (2 * k + exchanged) * slot_;
      bundle.after[k] = slots + (2 * k + !exchanged) * slot_;
      if (before >= 0 && before < width_) {
        carryOver(volume_.span(row, before), span, k, bundle);
      }
    }
    follow(bundle, lines, backwards ? PathSum::kNext : PathSum::kFirst);
  }

  /// `length` pixels of one tile from row `start` on, of a chunk that begins with row `top`.
  void followColumns(int x, int lines, int start, int length, int top, bool upwards, bool exchanged) {
    const int before = upwards ? start + 1 : start - 1, way = upwards ? -1 : 1;
    const SearchTiles::Span span = volume_.span(start, x);
    PathBundle<T> bundle = bundleOf(span.count);
    bundle.length = length;
    bundle.step = way * rows_.step * static_cast<std::ptrdiff_t>(volume_.rowEntries(start));
    bundle.sums_step = way * static_cast<std::ptrdiff_t>(volume_.rowEntries(start));
    bundle.p2_step = way * width_;
    bundle.smallest = memory_.smallest.as<T>() + x;
    for (int k = 0; k < lines; ++k) {
      bundle.costs[k] = volume_.at<T>(rows_.imageRow(start), x + k);
      bundle.excess[k] = excess(start, x + k);
      bundle.p2[k] = memory_.down.as<T>() + static_cast<std::ptrdiff_t>(start + upwards) * width_ + x + k;
      bundle.before[k] = column(x + k, exchanged ? 1 : 0);
      bundle.after[k] = column(x + k, exchanged ? 0 : 1);
      bundle.totals[k] = totals(top, start, x + k);
      if (before >= 0 && before < rows_.count) {
        carryOver(volume_.span(before, x), span, k, bundle);
      }
    }
    follow(bundle, lines, upwards ? PathSum::kLast : PathSum::kNext);
  }

  const CostVolume& volume_;
  const RowGrid rows_;
  const cv::Mat& guide_;
  const Penalties<T>& penalties_;
  const int width_;
  const std::size_t slot_;
  std::size_t longest_row_ = 0;  // entries
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
    for (int i = 0; i < columns; ++i) paths.startColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width), 0);
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
    for (int i = 0; i < columns; ++i) {
      paths.startColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width), rows.count - 1);
    }
    for (int bottom = rows.count; bottom > 0; bottom -= chunk) {
      const int top = std::max(bottom - chunk, 0);
      const bool exchanged = (rows.count - bottom) % 2 != 0;
#pragma omp for schedule(static)
      for (int i = 0; i < columns; ++i) {
        paths.alongColumns(i * kBundleLines, std::min((i + 1) * kBundleLines, width), top, bottom, true, exchanged);
      }
#pragma omp for schedule(static)
      for (int row = top; row < bottom; ++row) {
        selections[omp_get_thread_num()].selectRow(row, paths.totals(top, row, 0), output);
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
  if (row_step > 1 && !volume.whole()) {
    throw std::invalid_argument("semi-global matching: of a volume of search tiles all rows take part, not every " +
                                std::to_string(row_step) + "th");
  }
  const RowGrid rows(volume.height(), row_step);
  if (volume.depth() == CostVolume::Depth::kU8) {
    workspace_->run<std::uint8_t>(volume, guide, params, rows, output);
  } else {
    workspace_->run<std::uint16_t>(volume, guide, params, rows, output);
  }
}

}  // namespace fdp_stereo
