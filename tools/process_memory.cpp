// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "process_memory.hpp"

#include <fstream>
#include <limits>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace fdp_stereo {
namespace {

/// A line "Field:   1234 kB" of /proc/self/status in MB.
double statusMb(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.compare(0, field.size(), field) == 0) return std::stod(line.substr(field.size())) / 1024.0;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double peakMemoryMb() { return statusMb("VmHWM:"); }
double currentMemoryMb() { return statusMb("VmRSS:"); }

bool resetPeakMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ofstream clear("/proc/self/clear_refs");
  return static_cast<bool>(clear << "5" << std::flush);
}

}  // namespace fdp_stereo
