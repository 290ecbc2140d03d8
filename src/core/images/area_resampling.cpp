// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/area_resampling.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parallel.hpp"

namespace fdp_stereo {
namespace {

/// What a pixel of the smaller axis covers of the larger one. Both have small * large parts, so that all is whole:
/// a pixel of the smaller axis has `large` of them, one of the larger axis `small`.
struct Cover {
  std::int64_t begin, end, small;
  int first, last;

  Cover(int at, int small_size, int large_size)
      : begin(static_cast<std::int64_t>(at) * large_size),
        end(begin + large_size),
        small(small_size),
        first(static_cast<int>(begin / small)),
        last(static_cast<int>((end - 1) / small)) {}
  std::uint32_t parts(int pixel) const {
    return static_cast<std::uint32_t>(std::min(end, (pixel + 1) * small) - std::max(begin, pixel * small));
  }
};

using Sums = std::vector<std::uint32_t>;

/// Of the rows that row y of the smaller image covers.
template <typename Value>
void addRows(const cv::Mat& image, const Cover& rows, Sums& sums) {
  std::fill(sums.begin(), sums.end(), 0);
  for (int row = rows.first; row <= rows.last; ++row) {
    const std::uint32_t parts = rows.parts(row);
    const auto* values = image.ptr<Value>(row);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += parts * values[i];
  }
}

template <typename Value>
void shrink(const cv::Mat& image, cv::Mat& small) {
  const int channels = image.channels();
  const double share = 1.0 / (static_cast<double>(image.cols) * image.rows);
  std::vector<Cover> covers;
  for (int x = 0; x < small.cols; ++x) covers.emplace_back(x, small.cols, image.cols);
  const auto fill_row = [&](int y, Sums& sums) {
    addRows<Value>(image, Cover(y, small.rows, image.rows), sums);
    auto* to = small.ptr<Value>(y);
    for (const Cover& columns : covers) {
      for (int channel = 0; channel < channels; ++channel) {
        std::uint64_t sum = 0;
        for (int column = columns.first; column <= columns.last; ++column) {
          sum += static_cast<std::uint64_t>(columns.parts(column)) * sums[column * channels + channel];
        }
        *to++ = static_cast<Value>(cvRound(static_cast<double>(sum) * share));
      }
    }
  };
  parallelFor(
      small.rows, [&] { return Sums(static_cast<std::size_t>(image.cols) * channels); }, fill_row);
}

}  // namespace

cv::Mat shrinkByArea(const cv::Mat& image, cv::Size size) {
  cv::Mat small(size, image.type());
  image.depth() == CV_8U ? shrink<std::uint8_t>(image, small) : shrink<std::uint16_t>(image, small);
  return small;
}

}  // namespace fdp_stereo
