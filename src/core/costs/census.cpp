// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/census.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "parallel.hpp"
#include "simd/census_kernels.hpp"

namespace fdp_stereo {
namespace {

void compare(const CensusKernels& kernels, const std::uint8_t* neighbour, const std::uint8_t* centre, int count,
             std::uint8_t* bits) {
  kernels.compareU8(neighbour, centre, count, bits);
}
void compare(const CensusKernels& kernels, const std::uint16_t* neighbour, const std::uint16_t* centre, int count,
             std::uint8_t* bits) {
  kernels.compareU16(neighbour, centre, count, bits);
}

/// The bits of one row from the rows around it, each with window_width / 2 replicated pixels on both sides: up to 8 of
/// each pixel at a time are handed to take(number of bits), in `bits`.
template <typename T, typename Take>
void censusRow(const std::vector<const T*>& rows, int width, const CensusParams& params, std::uint8_t* bits,
               Take take) {
  const CensusKernels& kernels = FDP_STEREO_SELECT(censusKernels);
  const int centre_row = params.window_height / 2;
  const int centre_column = params.window_width / 2;
  const T* centre = rows[centre_row] + centre_column;
  std::fill(bits, bits + width, 0);
  int pending = 0;
  for (int j = 0; j < params.window_height; ++j) {
    for (int i = 0; i < params.window_width; ++i) {
      if (j == centre_row && i == centre_column) continue;
      compare(kernels, rows[j] + i, centre, width, bits);
      if (++pending < 8) continue;
      take(pending);
      std::fill(bits, bits + width, 0);
      pending = 0;
    }
  }
  if (pending > 0) take(pending);
}

/// Row y with window_width / 2 replicated pixels on both sides; y is clamped into the image.
template <typename T>
void padRow(const cv::Mat& grey, int y, int border, T* padded) {
  const T* row = grey.ptr<T>(std::clamp(y, 0, grey.rows - 1));
  std::fill(padded, padded + border, row[0]);
  std::copy(row, row + grey.cols, padded + border);
  std::fill(padded + border + grey.cols, padded + 2 * border + grey.cols, row[grey.cols - 1]);
}

template <typename T, typename Take>
void censusRowAt(const cv::Mat& grey, const CensusParams& params, int y, Take take) {
  thread_local std::vector<T> window;  // keep their memory from row to row
  thread_local std::vector<std::uint8_t> bits;
  thread_local std::vector<const T*> rows;
  const int border = params.window_width / 2;
  const std::size_t length = static_cast<std::size_t>(grey.cols) + 2 * border;
  window.resize(length * params.window_height);
  bits.resize(grey.cols);
  rows.resize(params.window_height);
  for (int j = 0; j < params.window_height; ++j) {
    padRow(grey, y + j - params.window_height / 2, border, window.data() + j * length);
    rows[j] = window.data() + j * length;
  }
  censusRow(rows, grey.cols, params, bits.data(), [&](int count) { take(bits.data(), count); });
}

template <typename Take>
void censusRowOf(const cv::Mat& grey, const CensusParams& params, int y, Take take) {
  if (grey.depth() == CV_8U) {
    censusRowAt<std::uint8_t>(grey, params, y, take);
  } else {
    censusRowAt<std::uint16_t>(grey, params, y, take);
  }
}

}  // namespace

void checkCensus(const cv::Mat& grey, const CensusParams& params) {
  if (grey.type() != CV_8UC1 && grey.type() != CV_16UC1) {
    throw std::invalid_argument("census needs a grey image of 8 or 16 bits, not type " + std::to_string(grey.type()));
  }
  const bool odd = params.window_width % 2 == 1 && params.window_height % 2 == 1;
  const int neighbours = params.window_width * params.window_height - 1;
  if (!odd || params.window_width < 1 || params.window_height < 1 || neighbours < 1 || neighbours > 64) {
    throw std::invalid_argument("census window " + std::to_string(params.window_width) + " x " +
                                std::to_string(params.window_height) + ": sides must be odd, with 1 to 64 neighbours");
  }
}

void computeCensusRow(const cv::Mat& grey, const CensusParams& params, int y, std::uint64_t* codes) {
  const CensusKernels& kernels = FDP_STEREO_SELECT(censusKernels);
  std::fill(codes, codes + grey.cols, 0);
  censusRowOf(grey, params, y,
              [&](const std::uint8_t* bits, int count) { kernels.append(bits, grey.cols, count, codes); });
}

int censusBytes(const CensusParams& params) { return (params.window_width * params.window_height - 1 + 7) / 8; }

void computeCensusBytes(const cv::Mat& grey, const CensusParams& params, int y, std::uint8_t* planes) {
  censusRowOf(grey, params, y, [&](const std::uint8_t* bits, int) {
    std::copy(bits, bits + grey.cols, planes);
    planes += grey.cols;
  });
}

void computeCensus(const cv::Mat& grey, const CensusParams& params, std::vector<std::uint64_t>& codes) {
  checkCensus(grey, params);
  codes.resize(grey.total());
  parallelFor(grey.rows, [&](int y) {
    computeCensusRow(grey, params, y, codes.data() + static_cast<std::size_t>(y) * grey.cols);
  });
}

}  // namespace fdp_stereo
