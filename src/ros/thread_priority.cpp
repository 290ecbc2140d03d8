// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "thread_priority.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace fdp_stereo {
namespace {

/// On Linux a nice level belongs to a thread.
bool setOwnLevel(int level) {
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  return getpriority(PRIO_PROCESS, thread) == level || setpriority(PRIO_PROCESS, thread, level) == 0;
}

}  // namespace

bool setNiceLevel(int level) {
  bool all = true;
#pragma omp parallel reduction(&& : all)
  all = setOwnLevel(level);
  return all;
}

}  // namespace fdp_stereo
