// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <optional>

namespace fdp_stereo {

/// Carries the first exception out of a parallel region: one that left the region by itself would end the process.
class ExceptionCarrier {
 public:
  template <typename Work>
  void run(Work&& work) noexcept {
    try {
      work();
    } catch (...) {
#pragma omp critical(fdp_stereo_exception)
      if (!error_) error_ = std::current_exception();
    }
  }
  /// After the region, in the calling thread.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::exception_ptr error_;
};

/// What a thread takes at a time, where one turn is a row.
constexpr int kRowsAtATime = 4;

/// body(i, scratch) for i = 0 .. count - 1 on all threads, each with a scratch of its own from makeScratch(). The first
/// exception of either is thrown again here, after all threads have ended.
template <typename MakeScratch, typename Body>
void parallelFor(int count, MakeScratch&& makeScratch, Body&& body, int chunk = kRowsAtATime) {
  ExceptionCarrier carrier;
#pragma omp parallel
  {
    std::optional<decltype(makeScratch())> scratch;
    carrier.run([&] { scratch.emplace(makeScratch()); });
#pragma omp for schedule(dynamic, chunk)
    for (int i = 0; i < count; ++i) {
      if (scratch) carrier.run([&] { body(i, *scratch); });
    }
  }
  carrier.rethrow();
}

/// body(i) for i = 0 .. count - 1 on all threads, exceptions as above.
template <typename Body>
void parallelFor(int count, Body&& body, int chunk = kRowsAtATime) {
  struct Nothing {};
  parallelFor(
      count, [] { return Nothing{}; }, [&](int i, Nothing&) { body(i); }, chunk);
}

}  // namespace fdp_stereo
