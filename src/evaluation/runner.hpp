// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/corruption.hpp"
#include "evaluation/method.hpp"
#include "evaluation/result.hpp"

namespace fdp_stereo {

struct RunOptions {
  bool all_pixels = false;                     ///< score occluded pixels too
  std::vector<const Corruption*> corruptions;  ///< each makes a scene of its own of every scene; empty = none
  int jobs = 1;                                ///< scenes at once; above 1 CPU time and memory are unknown
  int shard_index = 1;                         ///< of shard_count: this run does every shard_count-th scene
  int shard_count = 1;
  std::string folder;  ///< pictures and tables go here; "" = none
};

struct Failure {
  std::string scene;
  std::string problem;
};

struct RunOutcome {
  std::vector<ResultRow> rows;    ///< scene by scene, methods in their order
  std::vector<Failure> failures;  ///< scenes that could not be read or matched
};

/// Runs every method on every scene. With a folder, rows that an earlier run of the same settings left there are taken
/// over, and each new row is added to them as soon as it is known. A broken scene becomes a failure; the rest goes on.
/// Progress goes to stderr.
RunOutcome runMethods(const std::vector<std::string>& scene_paths, const std::vector<Method>& methods,
                      const RunOptions& options);

/// Name of the table that a shard writes into its folder.
std::string shardTableName(int index, int count);

}  // namespace fdp_stereo
