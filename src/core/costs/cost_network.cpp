// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "costs/cost_network.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "parallel.hpp"
#include "simd/cost_network_kernels.hpp"

namespace fdp_stereo {
namespace {

constexpr int kSides[] = {5, 3, 3};
constexpr int kShifts[] = {5, 10, 10};
constexpr std::int64_t kLargestInputs[] = {255, 1024, 1024};
constexpr int kBandRows = 16;  // that one thread computes at a time

void refuse(const std::string& what) { throw std::invalid_argument("weights of the cost network: " + what); }

int pairsOf(const CostNetwork::Layer& layer) { return (layer.side * layer.inputs + 1) / 2; }

/// One filter, from what is written one after the other into what the kernels read.
void takeFilter(const std::int32_t*& next, std::int64_t largest_input, int output, CostNetwork::Layer& layer) {
  std::int64_t largest_sum = 0;
  const int run = layer.side * layer.inputs, pairs = pairsOf(layer);
  for (int row = 0; row < layer.side; ++row) {
    for (int i = 0; i < run; ++i, ++next) {
      if (std::abs(*next) > 32767) refuse(std::to_string(*next) + " is beyond 16 bits");
      const int pair = row * pairs + i / 2;
      layer.weights[(static_cast<std::size_t>(pair) * layer.outputs + output) * 2 + i % 2] =
          static_cast<std::int16_t>(*next);
      largest_sum += std::abs(*next) * largest_input;
    }
  }
  layer.biases[output] = *next++;
  largest_sum += std::abs(static_cast<std::int64_t>(layer.biases[output])) + (std::int64_t{1} << layer.shift);
  if (largest_sum > INT32_MAX) refuse("the sums of a filter can leave 32 bits");
}

/// What one thread computes a band of rows in.
struct Band {
  std::vector<std::int16_t> maps[3];  // inputs of the layers
  std::vector<std::int32_t> sums;     // of one row
};

/// Rows first .. first + count - 1 as 16-bit numbers, with `border` px more on both sides and one number at the end.
void loadGrey(const cv::Mat& grey, int first, int count, int border, std::vector<std::int16_t>& map) {
  const int width = grey.cols + 2 * border;
  map.resize(static_cast<std::size_t>(count) * width + 1);
  std::int16_t* to = map.data();
  for (int y = first; y < first + count; ++y) {
    const auto* row = grey.ptr<std::uint8_t>(std::clamp(y, 0, grey.rows - 1));
    for (int x = -border; x < grey.cols + border; ++x) *to++ = row[std::clamp(x, 0, grey.cols - 1)];
  }
  *to = 0;
}

/// The sums of one row of a layer, of which `width` px are computed.
void convolveRow(const CostNetwork::Layer& layer, const std::int16_t* map, int map_width, int width,
                 std::vector<std::int32_t>& sums) {
  const std::int16_t* rows[5];
  for (int i = 0; i < layer.side; ++i) rows[i] = map + static_cast<std::ptrdiff_t>(i) * map_width * layer.inputs;
  const Convolution convolution{
      rows, layer.side, layer.inputs, pairsOf(layer), layer.weights.data(), layer.biases.data(), layer.outputs};
  sums.resize(static_cast<std::size_t>(width) * layer.outputs);
  FDP_STEREO_SELECT(costNetworkKernels).convolve(convolution, width, sums.data());
}

/// A descriptor of length kUnit at most from the sums of the last layer.
void normalise(const std::int32_t* sums, int length, int shift, double floor2, std::int8_t* descriptor) {
  std::int64_t square = 0;
  for (int i = 0; i < length; ++i) {
    const std::int64_t value = sums[i] >> shift;
    square += value * value;
  }
  const auto scale = static_cast<float>(CostNetwork::kUnit / std::sqrt(static_cast<double>(square) + floor2));
  for (int i = 0; i < length; ++i) {
    const float value = static_cast<float>(sums[i] >> shift) * scale;
    descriptor[i] = static_cast<std::int8_t>(value + (value < 0.0F ? -0.5F : 0.5F));
  }
}

}  // namespace

CostNetwork::CostNetwork(const NetworkWeights& weights) {
  std::size_t expected = 0;
  int inputs = 1;
  for (int i = 0; i < 3; ++i) {
    const int outputs = weights.channels[i];
    if (outputs < 8 || outputs > 32 || outputs % 8 != 0) {
      refuse(std::to_string(outputs) + " channels: 8, 16, 24 or 32 are possible");
    }
    layers_.push_back({kSides[i], inputs, outputs, kShifts[i], {}, std::vector<std::int32_t>(outputs)});
    layers_.back().weights.resize(static_cast<std::size_t>(kSides[i]) * pairsOf(layers_.back()) * outputs * 2);
    expected += static_cast<std::size_t>(outputs) * (kSides[i] * kSides[i] * inputs + 1);
    inputs = outputs;
  }
  if (weights.numbers.size() != expected) {
    refuse(std::to_string(weights.numbers.size()) + " numbers, " + std::to_string(expected) + " are needed");
  }
  const std::int32_t* next = weights.numbers.data();
  for (int i = 0; i < 3; ++i) {
    for (int output = 0; output < layers_[i].outputs; ++output) {
      takeFilter(next, kLargestInputs[i], output, layers_[i]);
    }
  }
  const double floor = weights.floor / 16.0;
  floor2_ = floor * floor;
}

const CostNetwork& CostNetwork::builtIn() {
  static const CostNetwork network(costNetworkWeights());
  return network;
}

void CostNetwork::describe(const cv::Mat& grey, cv::Mat& descriptors) const {
  descriptors.create(grey.rows, grey.cols * length(), CV_8SC1);
  const CostNetworkKernels& kernels = FDP_STEREO_SELECT(costNetworkKernels);
  const auto makeBand = [] { return Band{}; };
  const auto computeBand = [&](int index, Band& band) {
    const int first = index * kBandRows, count = std::min(kBandRows, grey.rows - first);
    int border = kReach;
    loadGrey(grey, first - border, count + 2 * border, border, band.maps[0]);
    for (int i = 0; i < 3; ++i) {
      const Layer& layer = layers_[i];
      const int map_width = grey.cols + 2 * border;
      border -= layer.side / 2;
      const int width = grey.cols + 2 * border, rows = count + 2 * border;
      if (i < 2) band.maps[i + 1].resize(static_cast<std::size_t>(rows) * width * layer.outputs);
      for (std::ptrdiff_t y = 0; y < rows; ++y) {
        convolveRow(layer, band.maps[i].data() + y * map_width * layer.inputs, map_width, width, band.sums);
        if (i < 2) {
          kernels.activate(band.sums.data(), width * layer.outputs, layer.shift,
                           band.maps[i + 1].data() + y * width * layer.outputs);
          continue;
        }
        auto* to = descriptors.ptr<std::int8_t>(first + static_cast<int>(y));
        for (std::ptrdiff_t x = 0; x < static_cast<std::ptrdiff_t>(width) * length(); x += length()) {
          normalise(band.sums.data() + x, length(), layer.shift, floor2_, to + x);
        }
      }
    }
  };
  parallelFor((grey.rows + kBandRows - 1) / kBandRows, makeBand, computeBand, 1);
}

}  // namespace fdp_stereo
