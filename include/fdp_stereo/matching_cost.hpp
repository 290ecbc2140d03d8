// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>

#include "fdp_stereo/census.hpp"
#include "fdp_stereo/cost_scale.hpp"
#include "fdp_stereo/cost_volume.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {

enum class MatchingCostType { kRhoCensus, kAdCensus, kCensus, kRho, kBirchfieldTomasi, kLearned };

/// Costs where x - d is outside the right image.
enum class CostBorder {
  kRepeatDisparity,  ///< the pixel's nearest valid cost along d
  kRepeatPixel,      ///< the cost of the nearest pixel of the row at which d is valid
};

/// Stage 4: C(p, d) from codes and colours (paper eq. 4-9).
struct MatchingCostParams {
  MatchingCostType type = MatchingCostType::kRhoCensus;
  CensusParams census;
  int scales = 1;                                         ///< census scales (eq. 7): 1 to 3
  std::array<double, 3> scale_weights = {0.7, 0.2, 0.1};  ///< w_i of eq. (7); divided by their sum over the scales used
  std::array<double, 3> scale_sigmas_px = {0.0, 1.0, 2.0};  ///< Gaussian blur of each scale
  double alpha = 1.0;                                       ///< eq. (8): share of the gradient
  double lambda_rho = 4.0;                                  ///< eq. (9)
  double lambda_census = 15.0;                              ///< eq. (9)
  double lambda_ad = 10.0;                                  ///< eq. (6)
  double rho_weight = 0.7;      ///< factor of the theta(rho) or theta(AD) term; 1 in the paper
  double learned_weight = 0.3;  ///< share of the learned cost beside that of kRhoCensus
  CostBorder border = CostBorder::kRepeatDisparity;
  bool adapt = true;  ///< smooth what noise, compression or one view out of focus have spoilt
};

/// Largest cost that the parameters can give (2 for the paper's form).
double maxMatchingCost(const MatchingCostParams& params);

/// Stage 4 with its buffers: after the first pair of a size it allocates no memory (blurred census scales excepted).
class MatchingCost {
 public:
  MatchingCost();
  ~MatchingCost();
  MatchingCost(MatchingCost&&) noexcept;
  MatchingCost& operator=(MatchingCost&&) noexcept;

  /// Fills the volume. Raw costs are rounded and at most round(max / scale.step).
  /// Where x - d leaves the right image the nearest valid cost along d is repeated.
  /// With a row_step, of the rows alone that SemiGlobalMatcher::match() takes then.
  /// Throws std::invalid_argument for a step with which the largest cost does not fit the depth.
  void compute(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params, const CostScale& scale,
               CostVolume& volume, int row_step = 1);
  /// The volume of search tiles, for CostBorder::kRepeatDisparity, from compute()'s of some rows of the same pair.
  void complete(const StereoPair& pair, const MatchingCostParams& params, const SearchTiles& tiles,
                const CostVolume& rows, int row_step, CostVolume& volume);

  struct Source;

 private:
  void fill(const StereoPair& pair, const MatchingCostParams& params, const CostScale& scale, int row_step,
            const CostVolume* known, CostVolume& volume);

  std::unique_ptr<Source> source_;
};

/// The same with buffers of its own.
void computeMatchingCost(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params,
                         const CostScale& scale, CostVolume& volume);

}  // namespace fdp_stereo
