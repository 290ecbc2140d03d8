// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Stage 3: census bit strings (paper 2.1.4 and 3.1).
struct CensusParams {
  int window_width = 5;   ///< px, odd; (width * height - 1) <= 64 bits
  int window_height = 5;  ///< px, odd
};

/// One code per pixel, row by row. Bit = neighbour < centre, neighbours in raster order, border replicated.
/// grey: CV_8UC1 or CV_16UC1. Throws std::invalid_argument for another type or a window over 64 neighbours.
void computeCensus(const cv::Mat& grey, const CensusParams& params, std::vector<std::uint64_t>& codes);

/// Throws what computeCensus() throws for such an image or window.
void checkCensus(const cv::Mat& grey, const CensusParams& params);

/// The codes of row y alone (0 <= y < rows), in memory for one code per column. Expects what checkCensus() lets pass.
void computeCensusRow(const cv::Mat& grey, const CensusParams& params, int y, std::uint64_t* codes);
/// Bytes that hold the bits of one code.
int censusBytes(const CensusParams& params);

/// The bits of row y byte by byte: of each pixel the first 8, then those of the next plane of `cols` bytes; the last
/// plane has the rest. Bits come in the order of the codes.
void computeCensusBytes(const cv::Mat& grey, const CensusParams& params, int y, std::uint8_t* planes);

}  // namespace fdp_stereo
