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

#include "disparity_selection.hpp"
#include "image_planes.hpp"
#include "kernels/semi_global_kernels.hpp"

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

void stepKernel(const SemiGlobalKernels& kernels, PathStep<std::uint8_t>& step, int paths, int count, bool add,
                std::uint16_t* sums) {
  kernels.stepU8(step, paths, count, add, sums);
}
void stepKernel(const SemiGlobalKernels& kernels, PathStep<std::uint16_t>& step, int paths, int count, bool add,
                std::uint16_t* sums) {
  kernels.stepU16(step, paths, count, add, sums);
}

/// Path costs of one sweep; keep their memory from image to image.
template <typename T>
struct SweepBuffers {
  std::array<std::vector<T>, 2> rows;      // of this row and the one before
  std::array<std::vector<T>, 2> smallest;  // of each path cost array in them
  std::array<std::vector<T>, 2> along;     // of the path along the row
  std::vector<T> nothing;                  // stands for a predecessor outside the image
};

/// One sweep over the image, downwards from the top left or upwards from the bottom right: the paths from the
/// predecessor in the row and from the row before.
template <typename T>
class Sweep {
 public:
  Sweep(const CostVolume& volume, const cv::Mat& grey, const Penalties<T>& penalties, int paths, bool upwards,
        SweepBuffers<T>& buffers)
      : volume_(volume),
        grey_(grey),
        penalties_(penalties),
        paths_(paths / 2),
        upwards_(upwards),
        width_(volume.width()),
        slot_(volume.stride() + CostVolume::kPadding),
        rows_(buffers.rows),
        smallest_(buffers.smallest),
        along_(buffers.along),
        nothing_(buffers.nothing) {
    const T guard = static_cast<T>(static_cast<T>(~T{0}) - penalties.p1);
    for (auto& row : rows_) row.assign(static_cast<std::size_t>(paths_ - 1) * width_ * slot_ + slot_, guard);
    for (auto& row : smallest_) row.assign(static_cast<std::size_t>(paths_ - 1) * width_, 0);
    for (auto& pixel : along_) pixel.assign(2 * slot_, guard);
    nothing_.assign(2 * slot_, 0);
  }

  /// Path costs of row y; rows come in the order of the sweep. sums: width x stride.
  void row(int y, bool add, std::uint16_t* sums) {
    const SemiGlobalKernels& kernels = FDP_STEREO_SELECT(semiGlobalKernels);
    PathStep<T> step;
    step.p1 = penalties_.p1;
    T smallest_along = 0;
    for (int i = 0; i < width_; ++i) {
      const int x = upwards_ ? width_ - 1 - i : i;
      step.costs = volume_.at<T>(y, x);
      connectAlong(i, x, y, smallest_along, step);
      for (int k = 1; k < paths_; ++k) connectBefore(k, x, y, step);
      stepKernel(kernels, step, paths_, volume_.stride(), add, sums + static_cast<std::size_t>(x) * volume_.stride());
      smallest_along = step.smallest_after[0];
      for (int k = 1; k < paths_; ++k) smallest_[current_][slotIndex(k, x)] = step.smallest_after[k];
    }
    current_ ^= 1;
    ++rows_done_;
  }

 private:
  std::size_t slotIndex(int path, int x) const { return static_cast<std::size_t>(path - 1) * width_ + x; }
  T* slot(int buffer, int path, int x) {
    return rows_[buffer].data() + slotIndex(path, x) * slot_ + CostVolume::kPadding;
  }

  void connect(int path, const T* before, T smallest, int difference, PathStep<T>& step) const {
    step.before[path] = before;
    step.smallest_before[path] = smallest;
    step.jump[path] = static_cast<T>(smallest + penalties_.p2[difference]);
  }

  void connectAlong(int i, int x, int y, T smallest, PathStep<T>& step) {
    const int x_before = upwards_ ? x + 1 : x - 1;
    step.after[0] = along_[i & 1].data() + CostVolume::kPadding;
    if (i == 0) return connect(0, nothing_.data() + CostVolume::kPadding, 0, 0, step);
    connect(0, along_[(i & 1) ^ 1].data() + CostVolume::kPadding, smallest, difference(x, y, x_before, y), step);
  }

  void connectBefore(int path, int x, int y, PathStep<T>& step) {
    // The middle path comes straight from the row before, the two others from its neighbours.
    const int x_before = paths_ == 2 ? x : x + path - 2;
    const int y_before = upwards_ ? y + 1 : y - 1;
    step.after[path] = slot(current_, path, x);
    if (rows_done_ == 0 || x_before < 0 || x_before >= width_) {
      return connect(path, nothing_.data() + CostVolume::kPadding, 0, 0, step);
    }
    connect(path, slot(current_ ^ 1, path, x_before), smallest_[current_ ^ 1][slotIndex(path, x_before)],
            difference(x, y, x_before, y_before), step);
  }

  int difference(int x, int y, int x_before, int y_before) const {
    return std::abs(grey_.ptr<std::uint8_t>(y)[x] - grey_.ptr<std::uint8_t>(y_before)[x_before]);
  }

  const CostVolume& volume_;
  const cv::Mat& grey_;
  const Penalties<T>& penalties_;
  const int paths_;
  const bool upwards_;
  const int width_;
  const std::size_t slot_;
  std::array<std::vector<T>, 2>& rows_;
  std::array<std::vector<T>, 2>& smallest_;
  std::array<std::vector<T>, 2>& along_;
  std::vector<T>& nothing_;
  int current_ = 0;
  int rows_done_ = 0;
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
  std::vector<std::uint16_t> sums;  // H x W x stride
  cv::Mat grey;                     // of colour images that have no 8-bit grey
  std::array<SweepBuffers<std::uint8_t>, 2> sweeps8;
  std::array<SweepBuffers<std::uint16_t>, 2> sweeps16;
  std::array<DisparitySelection, 2> selections;

  explicit Workspace(const SemiGlobalParams& params)
      : selections{DisparitySelection(params.subpixel, params.uniqueness_ratio),
                   DisparitySelection(params.subpixel, params.uniqueness_ratio)} {}

  template <typename T>
  void optimize(const OptimizerInput& input, const SemiGlobalParams& params, std::array<SweepBuffers<T>, 2>& buffers,
                OptimizerOutput& output);
};

/// Both sweeps start at their end of the image and store sums up to the middle; then each goes on over the rows of
/// the other, adds to its sums and decides. Two threads share the work without a lock, and the result does not depend
/// on whether there are two.
template <typename T>
void SemiGlobal::Workspace::optimize(const OptimizerInput& input, const SemiGlobalParams& params,
                                     std::array<SweepBuffers<T>, 2>& buffers, OptimizerOutput& output) {
  const CostVolume& volume = input.volume;
  const Penalties<T> penalties = makePenalties<T>(params, volume.step());
  const cv::Mat& guide = eightBitGrey(input.pair.left, input.pair.left_grey, grey);
  const int height = volume.height();
  const int middle = height / 2;
  const std::size_t row_sums = static_cast<std::size_t>(volume.width()) * volume.stride();
  if (sums.size() < row_sums * height) sums.resize(row_sums * height);
  std::array<Sweep<T>, 2> sweeps = {Sweep<T>(volume, guide, penalties, params.paths, false, buffers[0]),
                                    Sweep<T>(volume, guide, penalties, params.paths, true, buffers[1])};
  const int first[2] = {0, height - 1}, beyond[2] = {height, -1}, turn[2] = {middle, middle - 1}, step[2] = {1, -1};
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
  check(input.volume, params_);
  DisparitySelection::createMaps(input.volume.height(), input.volume.width(), output);
  if (input.volume.depth() == CostVolume::Depth::kU8) {
    workspace_->optimize(input, params_, workspace_->sweeps8, output);
  } else {
    workspace_->optimize(input, params_, workspace_->sweeps16, output);
  }
}

}  // namespace fdp_stereo
