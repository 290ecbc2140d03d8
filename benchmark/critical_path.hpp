// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

/// CPU time of what ran since startCriticalPath(), ms.
struct CriticalPath {
  double work = 0.0;    ///< of all threads
  double serial = 0.0;  ///< of the calling thread outside of parallel regions
  double path = 0.0;    ///< serial, and between two barriers of a region the time of its busiest thread
};

/// Measured by the clocks of the threads, so that there may be more of them than cores. A program that links this has
/// its parallel regions measured, and loops with a dynamic schedule dealt out in turns: on too few cores the threads
/// that happen to run would take all of the work. What it costs to wake the threads is not in it.
void startCriticalPath();
CriticalPath criticalPath();

}  // namespace fdp_stereo
