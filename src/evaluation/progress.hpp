// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <string>

namespace fdp_stereo {

/// A bar on a terminal, one line per step elsewhere; on stderr. Safe to call from several threads.
class Progress {
 public:
  explicit Progress(int steps);
  /// `count` steps are done; `what` names them.
  void step(const std::string& what, int count = 1);
  /// Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

 private:
  void drawBar(const std::string& what) const;

  std::mutex mutex_;
  int steps_;
  int done_ = 0;
  bool terminal_;
};

}  // namespace fdp_stereo
