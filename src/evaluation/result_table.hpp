// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "evaluation/result.hpp"

namespace fdp_stereo {

/// The table in the folder of a report. Rows are only ever added, each as soon as it is known: no run loses those of
/// another, and an interrupted run goes on where it was.
class ResultTable {
 public:
  /// Makes the table where there is none; takes away a last line that was cut. Throws std::runtime_error naming a file
  /// that is no such table or cannot be written.
  explicit ResultTable(const std::string& path);

  /// The row of an earlier run; null where there is none.
  const ResultRow* find(const std::string& scene, const std::string& method, const std::string& settings) const;
  /// From any thread.
  void add(const ResultRow& row);

 private:
  std::string path_;
  std::vector<ResultRow> earlier_;
  std::ofstream file_;
  std::mutex mutex_;
};

}  // namespace fdp_stereo
