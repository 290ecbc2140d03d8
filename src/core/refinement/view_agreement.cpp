// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "refinement/view_agreement.hpp"

#include <cstdint>

#include "parallel.hpp"
#include "refinement/regions.hpp"

namespace fdp_stereo {
namespace {

constexpr int kReachesPx[] = {2, 6};  ///< of the differences along the row
constexpr int kRowStep = 2;           ///< half of the rows tell enough of a region
constexpr int kSteps = 16;            ///< per pixel and grey level

/// More is not by chance, which chooses the best of many disparities: the smaller a region, the better it can.
double leastCorrelation(std::int64_t count) { return 0.25 + 2.5 / std::sqrt(static_cast<double>(count)); }

/// Sums of products of the fine structure of both views.
struct Agreement {
  std::int64_t both = 0, left = 0, right = 0, count = 0;
  bool vouched = false;

  void add(const Agreement& other) {
    both += other.both;
    left += other.left;
    right += other.right;
    count += other.count;
    vouched = vouched || other.vouched;
  }
  bool isChance() const {
    if (vouched || count == 0) return false;
    const double most = std::sqrt(static_cast<double>(left) * static_cast<double>(right));
    return static_cast<double>(both) < leastCorrelation(count) * most;
  }
};

/// A row of both views as far as a map knows the way from one to the other, in 1/kSteps grey levels.
class RowPair {
 public:
  explicit RowPair(int width) : left_(width), right_(width) {}

  void load(const std::uint8_t* left, const std::uint8_t* right, const float* disparity) {
    const int width = static_cast<int>(left_.size());
    for (int x = 0; x < width; ++x) {
      if (std::isnan(disparity[x])) continue;
      const int shift = static_cast<int>(std::lround(disparity[x] * kSteps));
      const int place = std::clamp(kSteps * x - shift, 0, kSteps * (width - 1));
      const int at = place / kSteps, part = place % kSteps;
      left_[x] = kSteps * left[x];
      right_[x] = right[at] * (kSteps - part) + right[std::min(at + 1, width - 1)] * part;
    }
  }

  /// Second differences: slopes are nothing.
  void addTo(int x, int reach, Agreement& agreement) const {
    const std::int64_t l = 2 * left_[x] - left_[x - reach] - left_[x + reach];
    const std::int64_t r = 2 * right_[x] - right_[x - reach] - right_[x + reach];
    agreement.both += l * r;
    agreement.left += l * l;
    agreement.right += r * r;
    ++agreement.count;
  }

 private:
  std::vector<int> left_, right_;
};

/// By run, from the pixels of its region in its row.
std::vector<Agreement> measureRuns(const SeenViews& views, const cv::Mat& disparity, const Regions& regions) {
  std::vector<Agreement> agreements(regions.runs());
  const auto measure_row = [&](int i, RowPair& rows) {
    const int y = kRowStep * i;
    const auto* d = disparity.ptr<float>(y);
    const auto* vouched = views.vouched.empty() ? nullptr : views.vouched.ptr<std::uint8_t>(y);
    const int* run = regions.row(y);
    rows.load(views.left.ptr<std::uint8_t>(y), views.right.ptr<std::uint8_t>(y), d);
    for (int x = 0; x < disparity.cols; ++x) {
      if (std::isnan(d[x])) continue;
      Agreement& agreement = agreements[run[x]];
      const int region = regions.regionOf(run[x]);
      for (const int reach : kReachesPx) {
        if (x < reach || x + reach >= disparity.cols) continue;
        if (regions.regionOf(run[x - reach]) != region || regions.regionOf(run[x + reach]) != region) continue;
        rows.addTo(x, reach, agreement);
      }
      if (vouched != nullptr && vouched[x] != 0) agreement.vouched = true;
    }
  };
  parallelFor((disparity.rows + kRowStep - 1) / kRowStep, [&] { return RowPair(disparity.cols); }, measure_row);
  return agreements;
}

}  // namespace

void filterRegions(const SeenViews& views, const SpeckleFilterParams& params, cv::Mat& disparity) {
  const Regions regions(disparity, static_cast<float>(params.max_difference_px));
  std::vector<Agreement> agreements = measureRuns(views, disparity, regions);
  for (int run = 0; run < regions.runs(); ++run) {
    const int region = regions.regionOf(run);
    if (region != run) agreements[region].add(agreements[run]);
  }
  regions.drop(disparity,
               [&](int region) { return regions.size(region) < params.max_size || agreements[region].isChance(); });
}

}  // namespace fdp_stereo
