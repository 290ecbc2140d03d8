// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace fdp_stereo {
namespace {
constexpr int kBarWidth = 30;
}

Progress::Progress(int steps) : steps_(std::max(1, steps)), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (terminal_ && done_ > 0) std::fputc('\n', stderr);
}

void Progress::step(const std::string& what, int count) {
  const std::lock_guard<std::mutex> lock(mutex_);
  done_ += count;
  if (terminal_) {
    drawBar(what);
  } else {
    std::fprintf(stderr, "[%d/%d] %s\n", done_, steps_, what.c_str());
  }
}

void Progress::drawBar(const std::string& what) const {
  const int filled = std::min(kBarWidth, kBarWidth * done_ / steps_);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kBarWidth - filled), '.');
  std::fprintf(stderr, "\r[%s] %d/%d %s\x1b[K", bar.c_str(), done_, steps_, what.c_str());
  std::fflush(stderr);
}

}  // namespace fdp_stereo
