// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "thread_priority.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <omp.h>

namespace fdp_stereo {
namespace {

/// On Linux a nice level belongs to a thread.
id_t ownThread() { return static_cast<id_t>(syscall(SYS_gettid)); }

bool setOwnLevel(int level) {
  return getpriority(PRIO_PROCESS, ownThread()) == level || setpriority(PRIO_PROCESS, ownThread(), level) == 0;
}

}  // namespace

bool setNiceLevel(int level, int threads) {
  // The team has the level of the thread that leads it: threads inherit it where they start.
  if (getpriority(PRIO_PROCESS, ownThread()) == level) return true;
  bool all = true;
#pragma omp parallel num_threads(threads > 0 ? threads : omp_get_num_procs()) reduction(&& : all)
  all = setOwnLevel(level);
  return all;
}

}  // namespace fdp_stereo
