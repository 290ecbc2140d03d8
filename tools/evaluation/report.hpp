// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/result.hpp"

namespace fdp_stereo {

/// Writes index.html into the folder of the pictures: one page with all tables, that needs no network. `conditions`
/// says how the figures came about. Throws std::runtime_error naming a file that cannot be written.
void writeReport(const std::string& folder, const std::vector<ResultRow>& rows, const std::string& conditions);

/// Rows of every shard's table in the folder (or of results.csv where there are no shards), sorted by scene. Throws
/// std::runtime_error where there is none or a shard is missing.
std::vector<ResultRow> mergeShards(const std::string& folder);

}  // namespace fdp_stereo
