// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

/// Gives the calling thread and its OpenMP team of so many threads (0 = all cores) the nice level (0..19). Returns
/// false where the system refuses.
bool setNiceLevel(int level, int threads);

}  // namespace fdp_stereo
