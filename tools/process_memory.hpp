// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

/// Largest resident memory of this process since its start or the last resetPeakMemory(), MB; NaN where the system
/// does not tell.
double peakMemoryMb();
/// Resident memory now, MB; NaN where the system does not tell.
double currentMemoryMb();
/// Gives free heap back to the system and begins a new peak. False where the system cannot (not Linux).
bool resetPeakMemory();

}  // namespace fdp_stereo
