// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/sparse_disparity.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "arguments.hpp"
#include "fdp_stereo/io.hpp"
#include "images/colour.hpp"
#include "seeds/seed_grid.hpp"
#include "seeds/seed_verification.hpp"

namespace fdp_stereo {
namespace {

constexpr int kNeighbours = 12;
/// Agreeing neighbours that a seed needs at least: one may be wrong in the same way.
constexpr int kMinAgreeing = 2;
/// |dI| at which the say of a neighbour falls to 1/e.
constexpr float kColourScale = 20.0F;

bool before(const Seed& a, const Seed& b) { return std::tie(a.y, a.x, a.d) < std::tie(b.y, b.x, b.d); }

bool inside(const Seed& seed, cv::Size size, DisparityRange range) {
  const bool in_image = seed.x >= 0.0F && seed.y >= 0.0F && seed.x <= static_cast<float>(size.width - 1) &&
                        seed.y <= static_cast<float>(size.height - 1);
  return in_image && range.contains(seed.d) && seed.trust > 0.0F;
}

Seed fromMatch(const FeatureMatch& match) {
  Seed seed;
  seed.x = match.left.x;
  seed.y = match.left.y;
  seed.d = match.disparity();
  seed.trust = match.trust;
  return seed;
}

float seedDistance(const cv::Mat& image, const Seed& a, const Seed& b) {
  const int channels = image.channels();
  return colourDistance(image.ptr<uchar>(cvRound(a.y)) + channels * cvRound(a.x),
                        image.ptr<uchar>(cvRound(b.y)) + channels * cvRound(b.x), channels);
}

/// Share of the neighbours' weight that agrees with the seed; 0 where too few do.
float support(const Seeds& seeds, const SeedGrid& grid, int index, const cv::Mat& left,
              const SparseDisparityParams& params) {
  const Seed& seed = seeds[index];
  const auto neighbours = grid.nearest(index, kNeighbours);
  if (neighbours.empty()) return 0.0F;
  const float reach = std::max(1.0F, neighbours.back().distance_px);
  float all = 0.0F;
  float agreeing = 0.0F;
  int count = 0;
  for (const SeedGrid::Neighbour& n : neighbours) {
    const Seed& other = seeds[n.index];
    const float weight =
        other.trust * std::exp(-n.distance_px / reach - seedDistance(left, seed, other) / kColourScale);
    all += weight;
    const double limit = params.tolerance_px + params.max_slope * n.distance_px;
    if (std::abs(other.d - seed.d) > limit) continue;
    agreeing += weight;
    ++count;
  }
  return count >= kMinAgreeing && all > 0.0F ? agreeing / all : 0.0F;
}

/// Keeps the seeds that `keep` says yes to; the others go to `rejected`.
template <typename Keep>
void filterSeeds(SparseDisparity& sparse, Keep keep) {
  Seeds kept;
  for (std::size_t i = 0; i < sparse.seeds.size(); ++i) (keep(i) ? kept : sparse.rejected).push_back(sparse.seeds[i]);
  sparse.seeds = std::move(kept);
}

/// Rejects matches whose surroundings do not move with them.
void rejectEdges(const StereoPair& pair, const SparseDisparityParams& params, SparseDisparity& sparse) {
  cv::Mat made_left, made_right;
  const cv::Mat& left = eightBitGrey(pair.left, pair.left_grey, made_left);
  const cv::Mat& right = eightBitGrey(pair.right, pair.right_grey, made_right);
  std::vector<float> deviations(sparse.seeds.size());
  for (int i = 0; i < static_cast<int>(deviations.size()); ++i) {
    const Seed& seed = sparse.seeds[i];
    deviations[i] = windowDeviation(left, right, {cvRound(seed.x), cvRound(seed.y)}, seed.d);
    sparse.seeds[i].trust *= 1.0F - 0.5F * deviations[i] / kMaxDeviationPx;
  }
  filterSeeds(sparse, [&](std::size_t i) { return deviations[i] <= static_cast<float>(params.max_deviation_px); });
}

/// Rejects seeds that their neighbours do not agree with.
void rejectLonely(const cv::Mat& left, const SparseDisparityParams& params, SparseDisparity& sparse) {
  const SeedGrid grid(sparse.seeds, left.size());
  std::vector<float> shares(sparse.seeds.size());
  for (int i = 0; i < static_cast<int>(shares.size()); ++i) shares[i] = support(sparse.seeds, grid, i, left, params);
  for (std::size_t i = 0; i < shares.size(); ++i) sparse.seeds[i].trust *= shares[i];
  filterSeeds(sparse, [&](std::size_t i) { return shares[i] >= static_cast<float>(params.min_support); });
}

}  // namespace

SparseDisparity buildSparseDisparity(const FeatureMatches& matches, const Seeds& external, const StereoPair& pair,
                                     DisparityRange range, const SparseDisparityParams& params) {
  SparseDisparity sparse;
  for (const FeatureMatch& match : matches) {
    const Seed seed = fromMatch(match);
    if (!inside(seed, pair.left.size(), range)) continue;
    const bool off_row = params.reject_outliers && std::abs(match.rowResidual()) > params.max_row_residual_px;
    (off_row ? sparse.rejected : sparse.seeds).push_back(seed);
  }
  if (params.reject_outliers) rejectEdges(pair, params, sparse);
  for (const Seed& seed : external) {
    if (inside(seed, pair.left.size(), range)) sparse.seeds.push_back(seed);
  }
  std::stable_sort(sparse.seeds.begin(), sparse.seeds.end(), before);
  if (params.reject_outliers) rejectLonely(pair.left, params, sparse);
  std::stable_sort(sparse.rejected.begin(), sparse.rejected.end(), before);
  return sparse;
}

cv::Mat drawSeeds(const cv::Mat& left, const SparseDisparity& sparse, DisparityRange range) {
  requireImage(left, left.size(), "picture of the seeds");
  const Seeds seeds = finiteSeeds(sparse.seeds);
  cv::Mat picture = left.clone();
  if (left.channels() == 1) cv::cvtColor(left, picture, cv::COLOR_GRAY2BGR);
  picture *= 0.5;
  cv::Mat disparities(1, static_cast<int>(seeds.size()), CV_32FC1);
  for (std::size_t i = 0; i < seeds.size(); ++i) disparities.at<float>(static_cast<int>(i)) = seeds[i].d;
  const cv::Mat colours = seeds.empty() ? cv::Mat() : colorize(disparities, range);
  for (const Seed& seed : finiteSeeds(sparse.rejected)) {
    cv::drawMarker(picture, {cvRound(seed.x), cvRound(seed.y)}, {230, 230, 230}, cv::MARKER_TILTED_CROSS, 5, 1);
  }
  const auto discs = std::count_if(seeds.begin(), seeds.end(),
                                   [](const Seed& seed) { return seed.source != SeedSource::kQuasiDense; });
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const cv::Point at(cvRound(seeds[i].x), cvRound(seeds[i].y));
    const cv::Scalar colour = colours.at<cv::Vec3b>(static_cast<int>(i));
    const bool dot = seeds[i].source == SeedSource::kQuasiDense;
    cv::circle(picture, at, dot ? 0 : (discs < 3000 ? 2 : 1), colour, cv::FILLED, dot ? cv::LINE_8 : cv::LINE_AA);
  }
  return picture;
}

}  // namespace fdp_stereo
