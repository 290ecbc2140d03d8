// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/quasi_dense.hpp"

namespace fdp_stereo {

/// Where surfaces can be: in every tile what a rough matching of its rows found several times, what is known of it and
/// of its eight neighbours, and the seeds of all of them. No spans where that leaves too little out.
SearchTiles findSearchTiles(const RoughDisparity& rough, const Seeds& seeds, cv::Size size, DisparityRange range,
                            int row_step);

}  // namespace fdp_stereo
