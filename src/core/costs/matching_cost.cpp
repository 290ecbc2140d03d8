// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/matching_cost.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "costs/cost_network.hpp"
#include "costs/image_planes.hpp"
#include "images/colour.hpp"
#include "parallel.hpp"
#include "row_grid.hpp"
#include "simd/cost_network_kernels.hpp"
#include "simd/matching_cost_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr int kMaxRhoUnits = 2047;  // rho of 64 grey levels: theta(64, 10) = 0.998
constexpr int kUnitsPerBit = 16;    // fixed point of S_census

bool usesColour(MatchingCostType type) { return type != MatchingCostType::kCensus; }
bool usesCensus(MatchingCostType type) {
  return type == MatchingCostType::kRhoCensus || type == MatchingCostType::kAdCensus ||
         type == MatchingCostType::kCensus || type == MatchingCostType::kLearned;
}
bool usesGradient(MatchingCostType type) {
  return type == MatchingCostType::kRhoCensus || type == MatchingCostType::kRho || type == MatchingCostType::kLearned;
}

/// theta of eq. (5).
double theta(double cost, double lambda) { return 1.0 - std::exp(-cost / lambda); }

/// Into memory of its own: the grey image may be the caller's.
cv::Mat blurred(const cv::Mat& grey, double sigma_px) {
  if (sigma_px <= 0.0) return grey;
  cv::Mat result;
  cv::GaussianBlur(grey, result, {}, sigma_px, 0, cv::BORDER_REPLICATE);
  return result;
}

/// Fixed-point theta: costs come in `units` per 1, weight * theta = result / 2^shift * step.
Theta makeTheta(double units, double lambda, double weight, double step, int shift) {
  const double largest = std::min(weight / step * (1 << shift) * 65536.0 / kDecayOne, 65535.0);
  return {makeDecay(lambda * units), static_cast<std::uint16_t>(largest)};
}

/// The same in a table, exactly.
void fillThetaTable(double units, double lambda, double weight, double step, int shift,
                    std::vector<std::uint16_t>& table) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double value = weight * theta(static_cast<double>(i) / units, lambda) / step * (1 << shift);
    table[i] = static_cast<std::uint16_t>(std::min(std::lround(value), 65535L));
  }
}

}  // namespace

/// All that the loop over the rows reads.
struct MatchingCost::Source {
  CensusParams census;
  ImagePlanes left, right;
  cv::Mat left_grey8, right_grey8;              // of 16-bit colour images
  cv::Mat left_blurred[3], right_blurred[3];    // one per scale
  cv::Mat left_descriptors, right_descriptors;  // of the learned cost
  LearnedMix learned{};
  int scales = 0;
  std::uint16_t bit_weights[3] = {};  // fixed-point w_i of eq. (7)
  int shift = 0;
  bool in_bytes = false;                                                                // one scale, 8-bit volume
  Theta rho_theta{};                                                                    // in bytes
  CensusTable census_costs{};                                                           // in bytes
  std::vector<std::uint16_t> rho_table = std::vector<std::uint16_t>(kMaxRhoUnits + 1);  // otherwise
  std::vector<std::uint16_t> census_table = std::vector<std::uint16_t>(3 * 64 * kUnitsPerBit + 1);

  void load(const StereoPair& pair, const MatchingCostParams& params, const CostScale& scale);
  /// Lets go of the images.
  void release();
  void loadLearned(const StereoPair& pair, const MatchingCostParams& params, const CostScale& scale);
  void loadCensus(const StereoPair& pair, const MatchingCostParams& params);
  void loadTheta(const MatchingCostParams& params, const CostScale& scale);
};

void MatchingCost::Source::loadCensus(const StereoPair& pair, const MatchingCostParams& params) {
  checkCensus(pair.left_grey, params.census);
  checkCensus(pair.right_grey, params.census);
  census = params.census;
  scales = std::clamp(params.scales, 1, 3);
  double sum = 0.0;
  for (int i = 0; i < scales; ++i) sum += params.scale_weights[i];
  for (int i = 0; i < scales; ++i) {
    left_blurred[i] = blurred(pair.left_grey, params.scale_sigmas_px[i]);
    right_blurred[i] = blurred(pair.right_grey, params.scale_sigmas_px[i]);
    const double weight = sum > 0.0 ? params.scale_weights[i] / sum : 1.0 / scales;
    bit_weights[i] = static_cast<std::uint16_t>(std::lround(weight * kUnitsPerBit));
  }
}

void MatchingCost::Source::loadTheta(const MatchingCostParams& params, const CostScale& scale) {
  const float step = scale.step;
  // Fractional bits that keep the largest cost inside 16 bits.
  shift = 0;
  while (shift < 7 && maxMatchingCost(params) / step * (2 << shift) < 65535.0) ++shift;
  const double lambda = usesGradient(params.type) ? params.lambda_rho : params.lambda_ad;
  const double census_weight = usesCensus(params.type) ? 1.0 : 0.0;
  const double colour_weight = usesColour(params.type) ? (usesCensus(params.type) ? params.rho_weight : 1.0) : 0.0;
  in_bytes = scale.depth == CostVolume::Depth::kU8 && scales <= 1;
  if (in_bytes) {
    rho_theta = makeTheta(kUnitsPerGreyLevel, lambda, colour_weight, step, shift);
    const auto room = std::lround(maxMatchingCost(params) / step) - std::lround(colour_weight / step);
    for (std::size_t bits = 0; bits < census_costs.size(); ++bits) {
      const double cost = census_weight * theta(static_cast<double>(bits), params.lambda_census) / step;
      census_costs[bits] = static_cast<std::uint8_t>(std::min(std::lround(cost), room));
    }
  } else {
    fillThetaTable(kUnitsPerGreyLevel, lambda, colour_weight, step, shift, rho_table);
    fillThetaTable(kUnitsPerBit, params.lambda_census, census_weight, step, shift, census_table);
  }
}

void MatchingCost::Source::loadLearned(const StereoPair& pair, const MatchingCostParams& params,
                                       const CostScale& scale) {
  learned.largest = static_cast<std::uint16_t>(std::lround(maxMatchingCost(params) / scale.step));
  learned.share = 0;
  if (params.type != MatchingCostType::kLearned) return;
  learned.share = static_cast<std::uint16_t>(std::lround(params.learned_weight * 256.0));
  const CostNetwork& network = CostNetwork::builtIn();
  network.describe(eightBitGrey(pair.left, pair.left_grey, left_grey8), left_descriptors);
  network.describe(eightBitGrey(pair.right, pair.right_grey, right_grey8), right_descriptors);
}

void MatchingCost::Source::load(const StereoPair& pair, const MatchingCostParams& params, const CostScale& scale) {
  const cv::Mat& grey_left = eightBitGrey(pair.left, pair.left_grey, left_grey8);
  const cv::Mat& grey_right = eightBitGrey(pair.right, pair.right_grey, right_grey8);
  left.clear();
  right.clear();
  if (params.type == MatchingCostType::kBirchfieldTomasi) {
    left.useBirchfieldTomasi(grey_left);
    right.useBirchfieldTomasi(grey_right);
  } else if (usesGradient(params.type)) {
    left.useRho(pair.left, grey_left, params.alpha);
    right.useRho(pair.right, grey_right, params.alpha);
  } else if (usesColour(params.type)) {
    left.useColour(pair.left);
    right.useColour(pair.right);
  }
  scales = 0;
  if (usesCensus(params.type)) loadCensus(pair, params);
  loadTheta(params, scale);
  loadLearned(pair, params, scale);
}

void MatchingCost::Source::release() {
  left.clear();
  right.clear();
  for (int i = 0; i < scales; ++i) {
    left_blurred[i].release();
    right_blurred[i].release();
  }
}

namespace {

using CostSource = MatchingCost::Source;

/// right[t] = row[width - 1 - min - t], clamped into the row: entry (width - 1 - x) + i meets left x at disparity min +
/// i.
template <typename T>
void reverseRow(const T* row, int width, int min, int length, T* right) {
  const int first = std::clamp(-min, 0, length), end = std::clamp(width - min, first, length);  // inside the row
  std::fill(right, right + first, row[width - 1]);
  for (int t = first; t < end; ++t) right[t] = row[width - 1 - min - t];
  std::fill(right + end, right + length, row[0]);
}

/// Buffers of one thread for one row.
struct RowScratch {
  std::vector<std::int16_t> left, right;               // planes; right ones reversed
  std::vector<std::uint64_t> left_codes, right_codes;  // [scale]; right ones reversed
  std::vector<std::int16_t> planes;                    // of the right row, as they come
  std::vector<std::uint64_t> codes;
  std::vector<std::uint8_t> left_bits, right_bits, bits;          // codes in bytes; right ones reversed
  std::vector<std::uint8_t> rho_costs;                            // of one pixel
  std::vector<std::uint16_t> rho, census, combined;               // of one pixel
  std::vector<std::int16_t> left_descriptors, right_descriptors;  // of the row; right ones reversed, in pairs
  std::vector<std::uint16_t> unlikeness;                          // of one pixel
};

void loadPlanes(const CostSource& source, int y, int width, int min, int length, RowScratch& scratch) {
  const int count = source.left.count();
  scratch.left.resize(static_cast<std::size_t>(count) * width);
  scratch.planes.resize(static_cast<std::size_t>(count) * width);
  scratch.right.resize(static_cast<std::size_t>(count) * length);
  source.left.fillRow(y, scratch.left.data());
  source.right.fillRow(y, scratch.planes.data());
  for (std::ptrdiff_t c = 0; c < count; ++c) {
    reverseRow(scratch.planes.data() + c * width, width, min, length, scratch.right.data() + c * length);
  }
}

void loadCodes(const CostSource& source, int y, int width, int min, int length, RowScratch& scratch) {
  scratch.left_codes.resize(static_cast<std::size_t>(source.scales) * width);
  scratch.codes.resize(width);
  scratch.right_codes.resize(static_cast<std::size_t>(source.scales) * length);
  for (std::ptrdiff_t i = 0; i < source.scales; ++i) {
    computeCensusRow(source.left_blurred[i], source.census, y, scratch.left_codes.data() + i * width);
    computeCensusRow(source.right_blurred[i], source.census, y, scratch.codes.data());
    reverseRow(scratch.codes.data(), width, min, length, scratch.right_codes.data() + i * length);
  }
}

void loadBytes(const CostSource& source, int y, int width, int min, int length, RowScratch& scratch) {
  const int count = source.scales * censusBytes(source.census);
  scratch.left_bits.resize(static_cast<std::size_t>(count) * width);
  scratch.bits.resize(static_cast<std::size_t>(count) * width);
  scratch.right_bits.resize(static_cast<std::size_t>(count) * length);
  if (count == 0) return;
  computeCensusBytes(source.left_blurred[0], source.census, y, scratch.left_bits.data());
  computeCensusBytes(source.right_blurred[0], source.census, y, scratch.bits.data());
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    reverseRow(scratch.bits.data() + k * width, width, min, length, scratch.right_bits.data() + k * length);
  }
}

void loadDescriptors(const CostSource& source, int y, int width, int min, int length, RowScratch& scratch) {
  const int channels = CostNetwork::builtIn().length();
  const auto* left = source.left_descriptors.ptr<std::int8_t>(y);
  scratch.left_descriptors.assign(left, left + static_cast<std::ptrdiff_t>(width) * channels);
  const auto* right = source.right_descriptors.ptr<std::int8_t>(y);
  scratch.right_descriptors.resize(static_cast<std::size_t>(length) * channels);
  for (int t = 0; t < length; ++t) {
    const std::int8_t* from =
        right + static_cast<std::ptrdiff_t>(std::clamp(width - 1 - min - t, 0, width - 1)) * channels;
    for (int c = 0; c < channels; ++c) {
      // NOLINTNEXTLINE(bugprone-signed-char-misuse): they are signed numbers
      scratch.right_descriptors[2 * (static_cast<std::size_t>(c / 2) * length + t) + c % 2] = from[c];
    }
  }
}

void loadRow(const CostSource& source, int y, int width, const CostVolume& volume, RowScratch& scratch) {
  const int length = width + volume.stride();
  if (source.left.count() > 0) loadPlanes(source, y, width, volume.range().min, length, scratch);
  if (source.learned.share > 0) loadDescriptors(source, y, width, volume.range().min, length, scratch);
  scratch.unlikeness.resize(volume.stride());
  (source.in_bytes ? loadBytes : loadCodes)(source, y, width, volume.range().min, length, scratch);
  scratch.rho.assign(volume.stride(), 0);
  scratch.census.assign(volume.stride(), 0);
  scratch.combined.resize(volume.stride());
  scratch.rho_costs.resize(volume.stride());
}

void combine(const MatchingCostKernels& kernels, const CostSource& source, const RowScratch& scratch, int count,
             std::uint16_t* costs) {
  kernels.combineU16(scratch.rho.data(), source.rho_table.data(), scratch.census.data(), source.census_table.data(),
                     count, source.shift, costs);
}
void combine(const MatchingCostKernels& kernels, const CostSource& source, RowScratch& scratch, int count,
             std::uint8_t* costs) {
  combine(kernels, source, scratch, count, scratch.combined.data());
  std::transform(scratch.combined.begin(), scratch.combined.begin() + count, costs,
                 [](std::uint16_t cost) { return static_cast<std::uint8_t>(cost); });
}

/// The planes of a pixel and of those it is compared with.
struct PixelPlanes {
  std::int16_t left[5] = {};
  const std::int16_t* right;
  int count, stride;
};

/// A pixel of a row, and which of its costs are made: `count` from index `first` on.
struct CostPixel {
  int x, width, stride;  ///< of the row; of all disparities
  int first, count;

  int length() const { return width + stride; }          ///< of the reversed right rows
  int partner() const { return width - 1 - x + first; }  ///< in them, of the first cost
};

PixelPlanes planesAt(const CostSource& source, const CostPixel& at, const RowScratch& scratch) {
  PixelPlanes planes{{}, scratch.right.data() + at.partner(), source.left.count(), at.length()};
  for (int c = 0; c < planes.count; ++c) planes.left[c] = scratch.left[static_cast<std::size_t>(c) * at.width + at.x];
  return planes;
}

/// The costs of one pixel where they are made in bytes: from its planes and one scale of census bits.
void byteCosts(const CostSource& source, MatchingCostType type, const CostPixel& at, RowScratch& scratch,
               std::uint8_t* costs) {
  const MatchingCostKernels& kernels = FDP_STEREO_SELECT(matchingCostKernels);
  const PixelPlanes planes = planesAt(source, at, scratch);
  std::uint8_t* const rho = scratch.rho_costs.data();
  if (type == MatchingCostType::kBirchfieldTomasi) {
    kernels.birchfieldTomasi(planes.left, planes.right, planes.stride, at.count, kMaxRhoUnits, scratch.rho.data());
    kernels.thetaCosts(scratch.rho.data(), source.rho_theta, at.count, source.shift, rho);
  } else if (planes.count > 0) {
    kernels.differenceCosts(planes.left, planes.right, planes.count, planes.stride, source.rho_theta, at.count,
                            source.shift, rho);
  }
  kernels.addCensusCosts(scratch.left_bits.data() + at.x, at.width, scratch.right_bits.data() + at.partner(),
                         at.length(), source.scales * censusBytes(source.census), at.count, source.census_costs, rho,
                         costs);
}

/// The costs of one pixel by tables.
template <typename T>
void tableCosts(const CostSource& source, MatchingCostType type, const CostPixel& at, RowScratch& scratch, T* costs) {
  const MatchingCostKernels& kernels = FDP_STEREO_SELECT(matchingCostKernels);
  const PixelPlanes planes = planesAt(source, at, scratch);
  if (type == MatchingCostType::kBirchfieldTomasi) {
    kernels.birchfieldTomasi(planes.left, planes.right, planes.stride, at.count, kMaxRhoUnits, scratch.rho.data());
  } else if (planes.count > 0) {
    kernels.absoluteDifferences(planes.left, planes.right, planes.count, planes.stride, at.count, kMaxRhoUnits,
                                scratch.rho.data());
  }
  for (std::ptrdiff_t i = 0; i < source.scales; ++i) {
    kernels.hamming(scratch.left_codes[i * at.width + at.x],
                    scratch.right_codes.data() + i * at.length() + at.partner(), at.count, source.bit_weights[i],
                    i == 0, scratch.census.data());
  }
  combine(kernels, source, scratch, at.count, costs);
}

template <typename T>
void costsOfPixel(const CostSource& source, MatchingCostType type, const CostPixel& at, RowScratch& scratch, T* costs) {
  if constexpr (sizeof(T) == 1) {
    if (source.in_bytes) return byteCosts(source, type, at, scratch, costs);
  }
  tableCosts(source, type, at, scratch, costs);
}

void mix(const CostNetworkKernels& kernels, const std::uint16_t* values, LearnedMix share, int count,
         std::uint8_t* costs) {
  kernels.mixU8(values, share, count, costs);
}
void mix(const CostNetworkKernels& kernels, const std::uint16_t* values, LearnedMix share, int count,
         std::uint16_t* costs) {
  kernels.mixU16(values, share, count, costs);
}

/// Mixes the learned costs of one pixel into the others.
template <typename T>
void addLearned(const CostSource& source, const CostPixel& at, RowScratch& scratch, T* costs) {
  const CostNetworkKernels& kernels = FDP_STEREO_SELECT(costNetworkKernels);
  const int channels = CostNetwork::builtIn().length();
  kernels.dissimilarities(scratch.left_descriptors.data() + static_cast<std::ptrdiff_t>(at.x) * channels,
                          scratch.right_descriptors.data() + std::ptrdiff_t{2} * at.partner(), channels / 2,
                          at.length(), at.count, scratch.unlikeness.data());
  mix(kernels, scratch.unlikeness.data(), source.learned, at.count, costs);
}

/// Repeats the nearest valid cost along d where x - d is outside the right image.
template <typename T>
void repeatBorder(T* costs, int x, int width, DisparityRange range, int stride, T max_raw) {
  const int first = std::clamp(x - (width - 1) - range.min, 0, range.count);  // x - d <= width - 1
  const int last = std::min(x - range.min, range.count - 1);                  // x - d >= 0
  if (last >= 0 && first < range.count) {
    for (int i = 0; i < first; ++i) costs[i] = costs[first];
    for (int i = last + 1; i < range.count; ++i) costs[i] = costs[last];
  }
  std::fill(costs + range.count, costs + stride, max_raw);
}

/// Repeats the cost of the nearest pixel of row y with a valid x - d, at each disparity.
template <typename T>
void repeatPixels(int y, CostVolume& volume) {
  const int last_x = volume.width() - 1;
  for (int i = 0; i < volume.range().count; ++i) {
    const int d = volume.range().min + i;
    for (int x = 0; x < std::min(d, last_x + 1); ++x) {
      volume.at<T>(y, x)[i] = volume.at<T>(y, std::min(d, last_x))[i];
    }
    for (int x = last_x; x > std::max(last_x + d, -1); --x) {
      volume.at<T>(y, x)[i] = volume.at<T>(y, std::max(last_x + d, 0))[i];
    }
  }
}

/// Row y of the images into row `row` of the volume.
template <typename T>
void fillRow(const CostSource& source, const MatchingCostParams& params, int y, int row, RowScratch& scratch,
             CostVolume& volume) {
  const int width = volume.width();
  loadRow(source, y, width, volume, scratch);
  const auto max_raw = static_cast<T>(volume.maxRaw());
  T* costs = volume.at<T>(row, 0);
  for (int left = 0; left < width; left = volume.tileRight(left)) {
    const SearchTiles::Span span = volume.span(row, left);
    CostPixel at{left, width, volume.stride(), span.first, volume.searched(span)};
    for (; at.x < volume.tileRight(left); ++at.x, costs += span.count) {
      costsOfPixel(source, params.type, at, scratch, costs);
      if (source.learned.share > 0) addLearned(source, at, scratch, costs);
      repeatBorder(costs, at.x, width, {volume.range().min + at.first, at.count}, span.count, max_raw);
    }
  }
  if (params.border == CostBorder::kRepeatPixel) repeatPixels<T>(row, volume);
}

template <typename T>
void copyRow(const CostVolume& from, int from_row, int row, CostVolume& volume) {
  for (int x = 0; x < volume.width(); ++x) {
    const SearchTiles::Span span = volume.span(row, x);
    std::copy_n(from.at<T>(from_row, x) + span.first, span.count, volume.at<T>(row, x));
  }
}

template <typename T>
void fillVolume(const CostSource& source, const MatchingCostParams& params, const RowGrid& rows,
                const CostVolume* known, CostVolume& volume) {
  const auto makeScratch = [] { return RowScratch{}; };
  parallelFor(volume.height(), makeScratch, [&](int row, RowScratch& scratch) {
    if (known == nullptr) return fillRow<T>(source, params, rows.imageRow(row), row, scratch, volume);
    if (rows.takes(row)) return copyRow<T>(*known, rows.rowOf(row), row, volume);
    fillRow<T>(source, params, row, row, scratch, volume);
  });
}

int largestRaw(const MatchingCostParams& params, const CostScale& scale) {
  const int max_raw = static_cast<int>(std::lround(maxMatchingCost(params) / scale.step));
  const bool bytes = scale.depth == CostVolume::Depth::kU8;
  if (!(scale.step > 0.0F) || max_raw > (bytes ? 255 : 65535)) {
    throw std::invalid_argument("matching cost step " + std::to_string(scale.step) + ": the largest cost must fit " +
                                (bytes ? "8" : "16") + " bits");
  }
  return max_raw;
}

}  // namespace

double maxMatchingCost(const MatchingCostParams& params) {
  const bool mixed = usesColour(params.type) && usesCensus(params.type);
  return mixed ? 1.0 + params.rho_weight : 1.0;
}

MatchingCost::MatchingCost() : source_(std::make_unique<Source>()) {}
MatchingCost::~MatchingCost() = default;
MatchingCost::MatchingCost(MatchingCost&&) noexcept = default;
MatchingCost& MatchingCost::operator=(MatchingCost&&) noexcept = default;

void MatchingCost::compute(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params,
                           const CostScale& scale, CostVolume& volume, int row_step) {
  const RowGrid rows(pair.left.rows, row_step);
  volume.create(rows.count, pair.left.cols, range, scale.depth, scale.step, largestRaw(params, scale));
  fill(pair, params, scale, row_step, nullptr, volume);
}

void MatchingCost::complete(const StereoPair& pair, const MatchingCostParams& params, const SearchTiles& tiles,
                            const CostVolume& rows, int row_step, CostVolume& volume) {
  const CostScale scale{rows.depth(), rows.step()};
  volume.create(pair.left.rows, pair.left.cols, rows.range(), scale.depth, scale.step, rows.maxRaw(), tiles);
  fill(pair, params, scale, row_step, &rows, volume);
}

void MatchingCost::fill(const StereoPair& pair, const MatchingCostParams& params, const CostScale& scale, int row_step,
                        const CostVolume* known, CostVolume& volume) {
  const RowGrid rows(pair.left.rows, row_step);
  source_->load(pair, params, scale);
  if (scale.depth == CostVolume::Depth::kU8) {
    fillVolume<std::uint8_t>(*source_, params, rows, known, volume);
  } else {
    fillVolume<std::uint16_t>(*source_, params, rows, known, volume);
  }
  source_->release();
}

void computeMatchingCost(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params,
                         const CostScale& scale, CostVolume& volume) {
  MatchingCost().compute(pair, range, params, scale, volume);
}

}  // namespace fdp_stereo
