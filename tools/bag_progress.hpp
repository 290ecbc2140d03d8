// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <unistd.h>

namespace fdp_stereo {

/// Frames, rate and time left; a line that is rewritten on a terminal, silent elsewhere.
class BagProgress {
 public:
  explicit BagProgress(std::size_t messages) : messages_(std::max<std::size_t>(1, messages)) {}
  ~BagProgress() {
    if (terminal_ && frames_ > 0) std::fputc('\n', stderr);
  }
  BagProgress(const BagProgress&) = delete;
  BagProgress& operator=(const BagProgress&) = delete;

  void frame(std::size_t messages_done) {
    ++frames_;
    if (!terminal_) return;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double share = static_cast<double>(messages_done) / static_cast<double>(messages_);
    std::fprintf(stderr, "\r%zu frames, %.1f Hz, %.0f %%, %.0f s left\x1b[K", frames_,
                 static_cast<double>(frames_) / seconds, 100.0 * share,
                 seconds * (1.0 - share) / std::max(share, 1e-6));
  }

 private:
  std::size_t messages_;
  std::size_t frames_ = 0;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace fdp_stereo
