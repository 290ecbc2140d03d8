// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/matching_cost.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "kernels/matching_cost_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr float kUnitsPerGreyLevel = 32.0F;  // fixed point of rho: 1 unit = 1/32 grey level
constexpr int kMaxRhoUnits = 2047;           // rho of 64 grey levels: theta(64, 10) = 0.998
constexpr int kUnitsPerBit = 16;             // fixed point of S_census

bool usesColour(MatchingCostType type) { return type != MatchingCostType::kCensus; }
bool usesCensus(MatchingCostType type) {
  return type == MatchingCostType::kRhoCensus || type == MatchingCostType::kAdCensus || type == MatchingCostType::kCensus;
}
bool usesGradient(MatchingCostType type) { return type == MatchingCostType::kRhoCensus || type == MatchingCostType::kRho; }

/// theta of eq. (5).
double theta(double cost, double lambda) { return 1.0 - std::exp(-cost / lambda); }

/// Fixed-point planes of one image, so that rho (eq. 8), AD (eq. 4) or Birchfield-Tomasi is a sum of differences.
struct Planes {
  std::vector<cv::Mat> data;  // CV_16SC1 each
};

cv::Mat scaled(const cv::Mat& image, double factor) {
  cv::Mat result;
  image.convertTo(result, CV_16S, factor);
  return result;
}

/// (1 - alpha) / 3 * colour, alpha * gradient (3 x 3 Sobel / 4). A grey image has one channel that counts in full.
Planes rhoPlanes(const cv::Mat& image, double alpha, bool gradient) {
  Planes planes;
  const double colour_share = gradient ? 1.0 - alpha : 1.0;
  cv::Mat channels[3];
  if (colour_share > 0.0) cv::split(image, channels);
  for (int c = 0; colour_share > 0.0 && c < image.channels(); ++c) {
    planes.data.push_back(scaled(channels[c], colour_share / image.channels() * kUnitsPerGreyLevel));
  }
  if (!gradient) return planes;
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  for (int dx : {1, 0}) {
    cv::Mat slope;
    cv::Sobel(grey, slope, CV_16S, dx, 1 - dx, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
    planes.data.push_back(scaled(slope, alpha / 4.0 * kUnitsPerGreyLevel));
  }
  return planes;
}

/// Value, and smallest and largest of the value and its means with the neighbours in the row (Birchfield-Tomasi 1998).
Planes birchfieldTomasiPlanes(const cv::Mat& image) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  Planes planes;
  for (int i = 0; i < 3; ++i) planes.data.push_back(scaled(grey, kUnitsPerGreyLevel));
  for (int y = 0; y < grey.rows; ++y) {
    const auto* value = planes.data[0].ptr<std::int16_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const int before = (value[x] + value[std::max(x - 1, 0)]) / 2;
      const int after = (value[x] + value[std::min(x + 1, grey.cols - 1)]) / 2;
      planes.data[1].at<std::int16_t>(y, x) = static_cast<std::int16_t>(std::min({before, after, int{value[x]}}));
      planes.data[2].at<std::int16_t>(y, x) = static_cast<std::int16_t>(std::max({before, after, int{value[x]}}));
    }
  }
  return planes;
}

/// All that the loop over the rows reads.
struct CostSource {
  Planes left, right;
  std::vector<std::vector<std::uint64_t>> left_codes, right_codes;  // one per scale
  std::vector<std::uint16_t> bit_weights;                            // fixed-point w_i of eq. (7)
  std::vector<std::uint16_t> rho_table, census_table;                // fixed-point theta of eq. (9)
  int shift = 0;
};

/// Into memory of its own: the grey image may be the caller's.
cv::Mat blurred(const cv::Mat& grey, double sigma_px) {
  if (sigma_px <= 0.0) return grey;
  cv::Mat result;
  cv::GaussianBlur(grey, result, {}, sigma_px, 0, cv::BORDER_REPLICATE);
  return result;
}

void addCensus(const StereoPair& pair, const MatchingCostParams& params, CostSource& source) {
  const int scales = std::clamp(params.scales, 1, 3);
  double sum = 0.0;
  for (int i = 0; i < scales; ++i) sum += params.scale_weights[i];
  source.left_codes.resize(scales);
  source.right_codes.resize(scales);
  for (int i = 0; i < scales; ++i) {
    computeCensus(blurred(pair.left_grey, params.scale_sigmas_px[i]), params.census, source.left_codes[i]);
    computeCensus(blurred(pair.right_grey, params.scale_sigmas_px[i]), params.census, source.right_codes[i]);
    const double weight = sum > 0.0 ? params.scale_weights[i] / sum : 1.0 / scales;
    source.bit_weights.push_back(static_cast<std::uint16_t>(std::lround(weight * kUnitsPerBit)));
  }
}

/// weight * theta(index / units, lambda) / step, in fixed point with `shift` fractional bits.
std::vector<std::uint16_t> thetaTable(int size, double units, double lambda, double weight, double step, int shift) {
  std::vector<std::uint16_t> table(size);
  for (int i = 0; i < size; ++i) {
    const double value = weight * theta(i / units, lambda) / step * (1 << shift);
    table[i] = static_cast<std::uint16_t>(std::min(std::lround(value), 65535L));
  }
  return table;
}

void addTables(const MatchingCostParams& params, float step, CostSource& source) {
  // Fractional bits that keep the largest cost inside 16 bits.
  while (source.shift < 7 && maxMatchingCost(params) / step * (2 << source.shift) < 65535.0) ++source.shift;
  const bool rho = usesGradient(params.type);
  const double lambda = rho ? params.lambda_rho : params.lambda_ad;
  const bool mixed = usesCensus(params.type);
  source.rho_table = thetaTable(kMaxRhoUnits + 1, kUnitsPerGreyLevel, lambda,
                                usesColour(params.type) ? (mixed ? params.rho_weight : 1.0) : 0.0, step, source.shift);
  source.census_table = thetaTable(3 * 64 * kUnitsPerBit + 1, kUnitsPerBit, params.lambda_census, mixed ? 1.0 : 0.0,
                                   step, source.shift);
}

CostSource makeSource(const StereoPair& pair, const MatchingCostParams& params, float step) {
  CostSource source;
  if (params.type == MatchingCostType::kBirchfieldTomasi) {
    source.left = birchfieldTomasiPlanes(pair.left);
    source.right = birchfieldTomasiPlanes(pair.right);
  } else if (usesColour(params.type)) {
    source.left = rhoPlanes(pair.left, params.alpha, usesGradient(params.type));
    source.right = rhoPlanes(pair.right, params.alpha, usesGradient(params.type));
  }
  if (usesCensus(params.type)) addCensus(pair, params, source);
  addTables(params, step, source);
  return source;
}

/// right[t] = row[width - 1 - min - t], clamped into the row: entry (width - 1 - x) + i meets left x at disparity min + i.
template <typename T>
void reverseRow(const T* row, int width, int min, int length, T* right) {
  for (int t = 0; t < length; ++t) right[t] = row[std::clamp(width - 1 - min - t, 0, width - 1)];
}

/// Buffers of one thread for one row.
struct RowScratch {
  std::vector<std::int16_t> right;          // planes, reversed
  std::vector<std::vector<std::uint64_t>> codes;  // per scale, reversed
  std::vector<std::uint16_t> rho, census;   // of one pixel
};

void loadRow(const CostSource& source, int y, int width, const CostVolume& volume, RowScratch& scratch) {
  const int length = width + volume.stride();
  const int min = volume.range().min;
  scratch.right.resize(source.right.data.size() * length);
  for (std::size_t c = 0; c < source.right.data.size(); ++c) {
    reverseRow(source.right.data[c].ptr<std::int16_t>(y), width, min, length, scratch.right.data() + c * length);
  }
  scratch.codes.resize(source.right_codes.size());
  for (std::size_t i = 0; i < source.right_codes.size(); ++i) {
    scratch.codes[i].resize(length);
    reverseRow(source.right_codes[i].data() + static_cast<std::size_t>(y) * width, width, min, length,
               scratch.codes[i].data());
  }
  scratch.rho.assign(volume.stride(), 0);
  scratch.census.assign(volume.stride(), 0);
}

void combine(const MatchingCostKernels& kernels, const CostSource& source, const RowScratch& scratch, int count,
             std::uint8_t* costs) {
  kernels.combineU8(scratch.rho.data(), source.rho_table.data(), scratch.census.data(), source.census_table.data(),
                    count, source.shift, costs);
}
void combine(const MatchingCostKernels& kernels, const CostSource& source, const RowScratch& scratch, int count,
             std::uint16_t* costs) {
  kernels.combineU16(scratch.rho.data(), source.rho_table.data(), scratch.census.data(), source.census_table.data(),
                     count, source.shift, costs);
}

template <typename T>
void costsOfPixel(const CostSource& source, MatchingCostType type, int y, int x, int width, RowScratch& scratch,
                  CostVolume& volume) {
  const MatchingCostKernels& kernels = FDP_STEREO_SELECT(matchingCostKernels);
  const int count = volume.range().count;
  const int length = width + volume.stride();
  const int offset = width - 1 - x;
  const int planes = static_cast<int>(source.left.data.size());
  std::int16_t left[5] = {};
  for (int c = 0; c < planes; ++c) left[c] = source.left.data[c].ptr<std::int16_t>(y)[x];
  const std::int16_t* right = scratch.right.data() + offset;
  if (type == MatchingCostType::kBirchfieldTomasi) {
    kernels.birchfieldTomasi(left, right, length, count, kMaxRhoUnits, scratch.rho.data());
  } else if (planes > 0) {
    kernels.absoluteDifferences(left, right, planes, length, count, kMaxRhoUnits, scratch.rho.data());
  }
  for (std::size_t i = 0; i < source.left_codes.size(); ++i) {
    const std::uint64_t code = source.left_codes[i][static_cast<std::size_t>(y) * width + x];
    kernels.hamming(code, scratch.codes[i].data() + offset, count, source.bit_weights[i], i == 0, scratch.census.data());
  }
  combine(kernels, source, scratch, count, volume.at<T>(y, x));
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

template <typename T>
void fillVolume(const CostSource& source, const MatchingCostParams& params, CostVolume& volume) {
  const int width = volume.width();
#pragma omp parallel
  {
    RowScratch scratch;
#pragma omp for schedule(static)
    for (int y = 0; y < volume.height(); ++y) {
      loadRow(source, y, width, volume, scratch);
      for (int x = 0; x < width; ++x) {
        costsOfPixel<T>(source, params.type, y, x, width, scratch, volume);
        repeatBorder(volume.at<T>(y, x), x, width, volume.range(), volume.stride(), static_cast<T>(volume.maxRaw()));
      }
      if (params.border == CostBorder::kRepeatPixel) repeatPixels<T>(y, volume);
    }
  }
}

}  // namespace

double maxMatchingCost(const MatchingCostParams& params) {
  const bool mixed = usesColour(params.type) && usesCensus(params.type);
  return mixed ? 1.0 + params.rho_weight : 1.0;
}

void computeMatchingCost(const StereoPair& pair, DisparityRange range, const MatchingCostParams& params, float step,
                         CostVolume& volume) {
  const int max_raw = static_cast<int>(std::lround(maxMatchingCost(params) / step));
  const int largest = params.bits == 8 ? 255 : 65535;
  if (!(step > 0.0F) || max_raw > largest) {
    throw std::invalid_argument("matching cost step " + std::to_string(step) + ": the largest cost must fit " +
                                std::to_string(params.bits) + " bits");
  }
  const auto depth = params.bits == 8 ? CostVolume::Depth::kU8 : CostVolume::Depth::kU16;
  volume.create(pair.left.rows, pair.left.cols, range, depth, step, max_raw);
  const CostSource source = makeSource(pair, params, step);
  if (depth == CostVolume::Depth::kU8) {
    fillVolume<std::uint8_t>(source, params, volume);
  } else {
    fillVolume<std::uint16_t>(source, params, volume);
  }
}

}  // namespace fdp_stereo
