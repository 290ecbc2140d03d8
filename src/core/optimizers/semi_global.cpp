// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/semi_global.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <omp.h>

#include "costs/image_planes.hpp"
#include "optimizers/disparity_selection.hpp"
#include "simd/semi_global_kernels.hpp"

namespace fdp_stereo {
namespace {

/// Penalties in raw units; P2 by the grey difference between two pixels.
template <typename T>
struct Penalties {
  T p1;
  std::array<T, 256> p2;
};

template <typename T>
Penalties<T> makePenalties(const SemiGlobalParams& params, float step) {
  Penalties<T> penalties;
  penalties.p1 = static_cast<T>(std::lround(params.p1 / step));
  for (int difference = 0; difference < 256; ++difference) {
    const double p2 = std::max(params.p1, params.p2 / (1.0 + params.p2_gradient * difference));
    penalties.p2[difference] = static_cast<T>(std::lround(p2 / step));
  }
  return penalties;
}

void sweepRow(const SemiGlobalKernels& kernels, const SweepRow<std::uint8_t>& row, int paths, bool add) {
  kernels.sweepRowU8(row, paths, add);
}
void sweepRow(const SemiGlobalKernels& kernels, const SweepRow<std::uint16_t>& row, int paths, bool add) {
  kernels.sweepRowU16(row, paths, add);
}

/// Path costs of one sweep; keep their memory from image to image.
template <typename T>
struct SweepBuffers {
  std::array<std::vector<T>, 2> rows;      // [path][pixel][slot] of this row and the one before
  std::array<std::vector<T>, 2> smallest;  // [path][pixel], of each slot in them
  std::vector<T> along;                    // two slots of the path along the row
  std::vector<T> p2;                       // [path][x]
};

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

/// One sweep over the rows, downwards from the top left or upwards from the bottom right: the paths from the
/// predecessor in the row and from the row before.
template <typename T>
class Sweep {
 public:
  Sweep(const CostVolume& volume, const RowGrid& rows, const cv::Mat& grey, const Penalties<T>& penalties, int paths,
        bool upwards, SweepBuffers<T>& buffers)
      : volume_(volume),
        rows_(rows),
        grey_(grey),
        penalties_(penalties),
        paths_(paths / 2),
        upwards_(upwards),
        width_(volume.width()),
        pixels_(width_ + 2),
        slot_(volume.stride() + CostVolume::kPadding),
        guard_(static_cast<T>(static_cast<T>(~T{0}) - penalties.p1)),
        buffers_(buffers) {
    // All predecessors of the first row, and those beside the image ever, are slots of zeros: they cost nothing.
    for (auto& row : buffers_.rows) {
      row.assign((paths_ - 1) * pixels_ * slot_ + CostVolume::kPadding, guard_);
      for (std::size_t pixel = 0; pixel < (paths_ - 1) * pixels_; ++pixel) clear(row.data() + pixel * slot_);
    }
    for (auto& row : buffers_.smallest) row.assign((paths_ - 1) * pixels_, 0);
    buffers_.along.assign(2 * slot_ + CostVolume::kPadding, guard_);
    buffers_.p2.resize(static_cast<std::size_t>(paths_) * width_);
  }

  /// Path costs of one row of the grid; rows come in the order of the sweep. sums: width x stride.
  void row(int number, bool add, std::uint16_t* sums) {
    SweepRow<T> row;
    row.width = width_;
    row.count = volume_.stride();
    row.backwards = upwards_;
    row.slot = static_cast<std::ptrdiff_t>(slot_);
    row.p1 = penalties_.p1;
    row.costs = volume_.at<T>(rows_.imageRow(number), 0);
    row.sums = sums;
    clear(buffers_.along.data() + slot_);
    for (int i = 0; i < 2; ++i) row.along[i] = buffers_.along.data() + i * slot_ + CostVolume::kPadding;
    for (int k = 0; k < paths_; ++k) row.p2[k] = fillJumps(k, number);
    for (int k = 1; k < paths_; ++k) connect(k, row);
    sweepRow(FDP_STEREO_SELECT(semiGlobalKernels), row, paths_, add);
    current_ ^= 1;
  }

 private:
  void clear(T* slot) const {
    std::fill(slot + CostVolume::kPadding, slot + CostVolume::kPadding + volume_.stride(), T{0});
  }

  /// Column of the predecessor less that of the pixel: the middle path comes straight from the row before.
  int shift(int path) const {
    if (path == 0) return upwards_ ? 1 : -1;
    return paths_ == 2 ? 0 : path - 2;
  }

  void connect(int path, SweepRow<T>& row) {
    // Pixel -1 comes first.
    const std::size_t before = (path - 1) * pixels_ + 1 + shift(path), after = (path - 1) * pixels_ + 1;
    row.before[path] = buffers_.rows[current_ ^ 1].data() + before * slot_ + CostVolume::kPadding;
    row.after[path] = buffers_.rows[current_].data() + after * slot_ + CostVolume::kPadding;
    row.smallest_before[path] = buffers_.smallest[current_ ^ 1].data() + before;
    row.smallest_after[path] = buffers_.smallest[current_].data() + after;
  }

  /// P2 of every pixel of a row towards its predecessor; outside the image there is none, and any value will do.
  const T* fillJumps(int path, int number) {
    const int before_number = path == 0 ? number : std::clamp(upwards_ ? number + 1 : number - 1, 0, rows_.count - 1);
    const auto* here = grey_.ptr<std::uint8_t>(rows_.imageRow(number));
    const auto* before = grey_.ptr<std::uint8_t>(rows_.imageRow(before_number)) + shift(path);
    T* p2 = buffers_.p2.data() + static_cast<std::size_t>(path) * width_;
    const int first = std::max(0, -shift(path)), last = width_ - std::max(0, shift(path));
    std::fill(p2, p2 + first, T{0});
    for (int x = first; x < last; ++x) p2[x] = penalties_.p2[std::abs(here[x] - before[x])];
    std::fill(p2 + last, p2 + width_, T{0});
    return p2;
  }

  const CostVolume& volume_;
  const RowGrid rows_;
  const cv::Mat& grey_;
  const Penalties<T>& penalties_;
  const int paths_;
  const bool upwards_;
  const int width_;
  const std::size_t pixels_;
  const std::size_t slot_;
  const T guard_;
  SweepBuffers<T>& buffers_;
  int current_ = 0;
};

void check(const CostVolume& volume, const SemiGlobalParams& params) {
  // One path cost holds a cost, P1 and P2; eight of them add up to 16 bits.
  const double largest = volume.maxRaw() + (params.p1 + params.p2) / volume.step() + 2;
  const double allowed = volume.depth() == CostVolume::Depth::kU8 ? 255 : 65535 / 8;
  if (largest > allowed) {
    throw std::invalid_argument("semi-global matching: cost, P1 and P2 need " + std::to_string(largest) +
                                " steps of the volume, but only " + std::to_string(allowed) + " fit");
  }
}

}  // namespace

struct SemiGlobal::Workspace {
  std::vector<std::uint16_t> sums;  // rows x W x stride
  cv::Mat grey;                     // of colour images that have no 8-bit grey
  std::array<SweepBuffers<std::uint8_t>, 2> sweeps8;
  std::array<SweepBuffers<std::uint16_t>, 2> sweeps16;
  std::array<DisparitySelection, 2> selections;

  explicit Workspace(const SemiGlobalParams& params)
      : selections{DisparitySelection(params.subpixel, params.uniqueness_ratio),
                   DisparitySelection(params.subpixel, params.uniqueness_ratio)} {}

  template <typename T>
  void optimize(const OptimizerInput& input, const SemiGlobalParams& params, int row_step,
                std::array<SweepBuffers<T>, 2>& buffers, OptimizerOutput& output);
};

/// Both sweeps start at their end of the image and store sums up to the middle; then each goes on over the rows of
/// the other, adds to its sums and decides. Two threads share the work without a lock, and the result does not depend
/// on whether there are two.
template <typename T>
void SemiGlobal::Workspace::optimize(const OptimizerInput& input, const SemiGlobalParams& params, int row_step,
                                     std::array<SweepBuffers<T>, 2>& buffers, OptimizerOutput& output) {
  const CostVolume& volume = input.volume;
  const Penalties<T> penalties = makePenalties<T>(params, volume.step());
  const cv::Mat& guide = eightBitGrey(input.pair.left, input.pair.left_grey, grey);
  const RowGrid rows(volume.height(), row_step);
  const int middle = rows.count / 2;
  const std::size_t row_sums = static_cast<std::size_t>(volume.width()) * volume.stride();
  if (sums.size() < row_sums * rows.count) {
    sums = std::vector<std::uint16_t>();  // first, so that the old ones do not lie beside the new ones
    sums.resize(row_sums * rows.count);
  }
  DisparitySelection::createMaps(rows.count, volume.width(), output);
  std::array<Sweep<T>, 2> sweeps = {Sweep<T>(volume, rows, guide, penalties, params.paths, false, buffers[0]),
                                    Sweep<T>(volume, rows, guide, penalties, params.paths, true, buffers[1])};
  const int first[2] = {0, rows.count - 1}, beyond[2] = {rows.count, -1}, turn[2] = {middle, middle - 1};
  const int step[2] = {1, -1};
#pragma omp parallel num_threads(std::min(2, omp_get_max_threads()))
  {
#pragma omp for schedule(static, 1)
    for (int s = 0; s < 2; ++s) {
      for (int y = first[s]; y != turn[s]; y += step[s]) sweeps[s].row(y, false, sums.data() + y * row_sums);
    }
#pragma omp for schedule(static, 1)
    for (int s = 0; s < 2; ++s) {
      for (int y = turn[s]; y != beyond[s]; y += step[s]) {
        sweeps[s].row(y, true, sums.data() + y * row_sums);
        selections[s].selectRow(y, sums.data() + y * row_sums, volume.width(), volume.stride(), volume.range(), output);
      }
    }
  }
}

SemiGlobal::SemiGlobal(const SemiGlobalParams& params)
    : params_(params), workspace_(std::make_unique<Workspace>(params)) {}
SemiGlobal::~SemiGlobal() = default;

void SemiGlobal::optimize(const OptimizerInput& input, OptimizerOutput& output) {
  optimizeRows(input, params_.paths, 1, output);
}

void SemiGlobal::optimizeRows(const OptimizerInput& input, int paths, int row_step, OptimizerOutput& output) {
  check(input.volume, params_);
  SemiGlobalParams params = params_;
  params.paths = paths;
  if (input.volume.depth() == CostVolume::Depth::kU8) {
    workspace_->optimize(input, params, row_step, workspace_->sweeps8, output);
  } else {
    workspace_->optimize(input, params, row_step, workspace_->sweeps16, output);
  }
}

int SemiGlobal::firstRow(int height, int row_step) { return RowGrid(height, row_step).imageRow(0); }

}  // namespace fdp_stereo
