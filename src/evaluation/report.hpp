// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/result.hpp"

namespace fdp_stereo {

/// How the figures came about, for the reader of the page.
struct ReportOrigin {
  std::string conditions;  ///< sentences
  std::string command;     ///< the command line
};

/// Writes index.html into the folder of the pictures: one page with all tables, that needs no network. Throws
/// std::runtime_error naming a file that cannot be written.
void writeReport(const std::string& folder, const std::vector<ResultRow>& rows, const ReportOrigin& origin);

/// Throws std::runtime_error where the folder has an index.html that writeReport() did not make.
void checkReport(const std::string& folder);

/// Unique rows of results.csv and of every shard's table in the folder, sorted by scene. Throws std::runtime_error
/// where there is no table or a shard is missing.
std::vector<ResultRow> mergeShards(const std::string& folder);

}  // namespace fdp_stereo
