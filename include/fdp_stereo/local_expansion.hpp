// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>

#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/optimizer.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

/// Where the first planes come from.
enum class PlaneInitialization {
  kRandom,      ///< one random plane per fine cell, as published
  kSemiGlobal,  ///< planes fitted to the disparities of semi-global matching on the same volume
};

/// Proposals of one visit to one cell of a layer.
struct PlaneProposals {
  int expansions = 2;  ///< planes of random pixels of the cell
  int ransac = 1;      ///< planes fitted to the disparities of the cell
  int random = 0;      ///< perturbed planes of the cell
};

/// LocalExp (Taniai et al., TPAMI 2018): continuous slanted planes by local expansion moves (paper 3.4, eq. 2 and 3).
struct LocalExpansionParams {
  // The energy.
  double lambda = 0.5;           ///< weight of the smoothness term
  double tau_smooth_px = 1.0;    ///< truncation of the plane distance psi_pq
  double gamma = 10.0 / 3.0;     ///< grey levels: w_pq = max(epsilon, exp(-|I_p - I_q| / gamma)); 10 for the sum of 3
  double epsilon = 0.01;         ///< smallest w_pq
  double data_scale = 0.5;       ///< factor of the matching cost, so that the largest is about 1
  double data_threshold = 0.5;   ///< truncation of the matching cost, after data_scale
  int disparity_steps = 1;       ///< costs per px of disparity; above 1 the matching cost is computed anew between them
  int filter_radius_px = 10;     ///< box radius of the guided filter over the slanted window
  double filter_epsilon = 1e-4;  ///< regularisation of the guided filter, colours in 0..1
  int margin_px = 5;             ///< a plane is invalid at a pixel if it leaves the range within this distance
  // The search.
  PlaneInitialization initialization = PlaneInitialization::kSemiGlobal;
  int unary_iterations = 0;    ///< first rounds without smoothness: a pixel takes what lowers its own cost
  int iterations = 5;          ///< rounds of expansion moves
  int right_iterations = 5;    ///< the same in the right view, which serves the check alone
  double fine_cell = 1.0;      ///< % of the image width
  double middle_cell = 3.0;    ///< % of the image width
  double coarse_cell = 9.0;    ///< % of the image width
  bool seed_proposals = true;  ///< offer the planes of the triangulated seeds
  PlaneProposals fine = {1, 1, 2};
  PlaneProposals middle = {2, 1, 1};
  PlaneProposals coarse = {2, 1, 1};
  int random_first_step = 3;         ///< random planes start within range / 2^(1 + step), halved with each further one
  double ransac_threshold_px = 1.0;  ///< distance of an inlier
  int ransac_samples = 100;          ///< three-point samples at most
  double stop_gain = 0.0;            ///< %: stop when a round lowers the energy by less; 0 = all rounds
  int seed = 0;                      ///< of the random numbers
  double max_time_ms = 0.0;          ///< return the best labelling after this time; 0 = no limit
  // Afterwards.
  bool both_views = true;            ///< label the right view too, check and fill
  double max_difference_px = 1.5;    ///< of the left-right check
  int median_radius_px = 20;         ///< weighted median on filled pixels; 0 = off
  double median_gamma = 10.0 / 3.0;  ///< grey levels: its weight exp(-|dI| / gamma)
};

/// A view of a pair as local expansion works on it: the right one is mirrored, so that both look alike.
enum class ExpandedView { kLeft, kRight };

/// What local expansion works on. References must outlive the call.
struct LocalExpansionInput {
  const CostVolume& volume;        ///< of the left view
  const StereoPair& pair;          ///< left as given, right aligned
  const Seeds& seeds;              ///< whose planes are offered
  const OptimizerOutput& initial;  ///< disparities of both views to start from, or empty maps
  /// Writes the costs of a view at `steps` entries per px of disparity; asked for where disparity_steps > 1.
  std::function<void(ExpandedView, int steps, CostVolume&)> finer_costs;
  const std::atomic<bool>* cancel = nullptr;  ///< set from another thread: return the best so far, soon
  OptimizerProgress progress;                 ///< may be empty
};

/// Stage 7 with planes. Gives dense maps of both views (filled after its own left-right check), and the left
/// view's energy before the first and after every round; the margin is what the data term is below its truncation, 0
/// where a plane was filled in. Throws std::invalid_argument where the volume does not fit the images, or where
/// disparity_steps > 1 and nobody gives finer costs.
void expandLocally(const LocalExpansionInput& input, const LocalExpansionParams& params, OptimizerOutput& output);

/// Bytes that it needs beside the volume for every cost in it.
double bytesPerCost(const LocalExpansionParams& params);

}  // namespace fdp_stereo
