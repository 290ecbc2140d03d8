// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/evaluation.hpp"

namespace fdp_stereo {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One method on one scene.
struct ResultRow {
  std::string scene;
  std::string method;
  std::string settings;  ///< fingerprints "METHOD-SCENE" of all that the figures depend on
  DisparityErrors errors;
  double time_ms = kUnknown;         ///< wall time of the run
  double cpu_ms = kUnknown;          ///< CPU time of the process meanwhile; unknown where several scenes run at once
  double memory_mb = kUnknown;       ///< peak above what was in use before; unknown likewise
  double seeds = kUnknown;           ///< number of seeds
  double seeds_wrong = kUnknown;     ///< % of the seeds with a truth that are off by more than 1 px
  double dense = kUnknown;           ///< number of seeds of the first, rough matching
  double dense_wrong = kUnknown;     ///< % of them, likewise
  double rows_before_px = kUnknown;  ///< robust RMS of the matches' row residuals as given
  double rows_after_px = kUnknown;   ///< and after row alignment
};

enum class Better { kSmaller, kLarger, kNeither };

/// One number of a row: its column name in the CSV, its heading, and which value is the better one.
struct Column {
  const char* name;
  const char* heading;
  Better better;
  double (*get)(const ResultRow&);
  void (*set)(ResultRow&, double);
};

/// The numbers of a row in the order of the table.
const std::vector<Column>& resultColumns();

/// Reads rows that writeCsv() wrote; a last line without an end, which was cut, is left out. Throws std::runtime_error
/// naming file and line.
std::vector<ResultRow> readCsv(const std::string& path);
/// Writes a header line and one line per row, in full precision. Throws std::runtime_error naming the file.
void writeCsv(const std::string& path, const std::vector<ResultRow>& rows);
/// One line, as writeCsv() has it.
std::string csvLine(const ResultRow& row);
std::string csvHeader();

/// The newest of the rows with the same scene, method and settings, each where the first of them was.
std::vector<ResultRow> uniqueRows(const std::vector<ResultRow>& rows);
/// The newest of the rows with the same scene and method, each where the first of them was.
std::vector<ResultRow> newestRows(const std::vector<ResultRow>& rows);
/// Unique rows, scene by scene. A method that ran with other settings before is called "NAME~SETTINGS" there, so that
/// no mean mixes them.
std::vector<ResultRow> rowsToShow(const std::vector<ResultRow>& rows);

/// Per kind of corruption and method the mean over its scenes, weighted as the Middlebury V3 table does; numbers that
/// some scene lacks are unknown. In order of first appearance; `scene` becomes "mean of N" or "mean of N+KIND".
std::vector<ResultRow> averageRows(const std::vector<ResultRow>& rows);

/// The rows as an aligned text table, averages below.
std::string tableText(const std::vector<ResultRow>& rows);

/// 64-bit FNV-1a of bytes, as 16 hexadecimal digits.
std::string fingerprint(std::string_view bytes);

}  // namespace fdp_stereo
