// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Stands before the functions of GCC's OpenMP library of the same name (libgomp's ABI), and calls them. Regions are not
// nested, and loops count up by one.
#include "critical_path.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <ctime>
#include <vector>

#include <omp.h>

namespace {

double threadMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

fdp_stereo::CriticalPath measured;
double serial_since = 0.0;

/// One parallel region: the CPU time of each thread from barrier to barrier.
struct Region {
  void (*body)(void*);
  void* data;
  std::vector<std::vector<double>> phases;  // by thread

  void finishPhase(double since) { phases[omp_get_thread_num()].push_back(threadMs() - since); }

  void addTo(fdp_stereo::CriticalPath& path) const {
    std::vector<double> busiest;
    for (const std::vector<double>& thread : phases) {
      busiest.resize(std::max(busiest.size(), thread.size()));
      for (std::size_t i = 0; i < thread.size(); ++i) {
        path.work += thread[i];
        busiest[i] = std::max(busiest[i], thread[i]);
      }
    }
    for (const double ms : busiest) path.path += ms;
  }
};

Region* region = nullptr;
thread_local double phase_since = 0.0;

void runThread(void* /*data*/) {
  phase_since = threadMs();
  region->body(region->data);
  region->finishPhase(phase_since);
}

/// The chunks of a loop that this thread takes: every n-th one.
struct Turns {
  long next, end, chunk;

  bool take(long* first, long* last) {
    if (next >= end) return false;
    *first = next;
    *last = std::min(next + chunk, end);
    next += chunk * omp_get_num_threads();
    return true;
  }
};
thread_local Turns turns;

void barrier() {
  region->finishPhase(phase_since);
  static const auto real = next<void()>("GOMP_barrier");
  real();
  phase_since = threadMs();
}

}  // namespace

extern "C" {

void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags) {
  static const auto real = next<void(void (*)(void*), void*, unsigned, unsigned)>("GOMP_parallel");
  measured.serial += threadMs() - serial_since;
  const int count = threads == 0 ? omp_get_max_threads() : static_cast<int>(threads);
  Region here{body, data, std::vector<std::vector<double>>(count)};
  region = &here;
  real(runThread, nullptr, threads, flags);
  region = nullptr;
  here.addTo(measured);
  serial_since = threadMs();
}

void GOMP_barrier() { barrier(); }

void GOMP_loop_end() { barrier(); }

bool GOMP_loop_nonmonotonic_dynamic_start(long start, long end, long /*step*/, long chunk, long* first, long* last) {
  turns = {start + chunk * omp_get_thread_num(), end, chunk};
  return turns.take(first, last);
}

bool GOMP_loop_nonmonotonic_dynamic_next(long* first, long* last) { return turns.take(first, last); }

void GOMP_loop_end_nowait() {}

}  // extern "C"

namespace fdp_stereo {

void startCriticalPath() {
  measured = {};
  serial_since = threadMs();
}

CriticalPath criticalPath() {
  const double now = threadMs();
  CriticalPath result = measured;
  result.serial += now - serial_since;
  result.work += result.serial;
  result.path += result.serial;
  return result;
}

}  // namespace fdp_stereo
