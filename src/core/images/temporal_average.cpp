// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/temporal_average.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "images/colour.hpp"
#include "images/image_quality.hpp"
#include "parallel.hpp"

namespace fdp_stereo {
namespace {

constexpr int kLongest = 16;  // pairs in a mean; beyond them the old ones fade
constexpr int kAges = kLongest + 1;
constexpr int kPeriod = 8;          // pairs after which what is shown of a mean that is this long follows it
constexpr int kWindow = 7;          // px, side of the window whose change is compared with the noise
constexpr double kMaxChange = 2.5;  // of the variance of the noise there; more is no noise
constexpr double kLeastNoise = 0.5, kMostNoise = 8.0;  // grey levels
constexpr int kBlockPx = 16;                           // side of the blocks that tell whether the camera stands
constexpr int kSubsteps = 8;                           // of a grey level, of changes
constexpr float kRounding = 0.5F;                      // of what becomes whole
constexpr int kLargestChange = 255;                    // beyond it all are alike

/// Whether what is shown follows a mean of so many pairs: 1, 2, 3, 4, 6, 8, 12. Between these steps a still view is the
/// same to the bit.
bool isStep(int age) {
  const auto powerOfTwo = [](int n) { return (n & (n - 1)) == 0; };
  return powerOfTwo(age) || (age % 3 == 0 && powerOfTwo(age / 3));
}

/// What the age of a pixel says, for every channel of a row.
struct AgeRow {
  AgeRow(int cols, int count_per_pixel)
      : channels(count_per_pixel), weight(cols * count_per_pixel), follows(cols * count_per_pixel) {}

  /// Returns whether anything of the row follows its mean.
  bool fill(const std::uint8_t* ages, int cols, bool longest_follow) {
    std::array<float, kAges> weights{};
    std::array<std::uint8_t, kAges> steps{};
    for (int age = 1; age < kAges; ++age) {
      weights[age] = 1.0F / static_cast<float>(age);
      steps[age] = (age < kLongest ? isStep(age) : longest_follow) ? 1 : 0;
    }
    std::uint8_t any = 0;
    for (int x = 0, i = 0; x < cols; ++x) {
      any |= steps[ages[x]];
      for (int c = 0; c < channels; ++c, ++i) {
        weight[i] = weights[ages[x]];
        follows[i] = steps[ages[x]];
      }
    }
    return any != 0;
  }

  int channels;
  std::vector<float> weight;          ///< of the newest value in the mean
  std::vector<std::uint8_t> follows;  ///< 1 where what is shown follows the mean
};

/// Shows the means that are followed, rounded; returns whether that changed anything.
template <typename Value>
bool showMeans(const float* means, const std::uint8_t* follows, int count, Value* shown) {
  int changes = 0;
  for (int i = 0; i < count; ++i) {
    const auto value = follows[i] != 0 ? static_cast<Value>(means[i] + kRounding) : shown[i];
    changes += value != shown[i] ? 1 : 0;
    shown[i] = value;
  }
  return changes > 0;
}

/// Squares of the differences from the mean, in parts of a grey level.
cv::Mat squaredChanges(const cv::Mat& grey, const cv::Mat& mean) {
  cv::Mat squares(grey.size(), CV_16UC1);
  parallelFor(grey.rows, [&](int y) {
    const auto* now = grey.ptr<std::uint8_t>(y);
    const auto* before = mean.ptr<float>(y);
    auto* square = squares.ptr<std::uint16_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const float difference = std::abs(static_cast<float>(now[x]) - before[x]) * kSubsteps;
      const int change = std::min(static_cast<int>(difference + kRounding), kLargestChange);
      square[x] = static_cast<std::uint16_t>(change * change);
    }
  });
  return squares;
}

/// A value that half of the magnitudes do not exceed, from how often each occurs; they were rounded.
double medianOf(const std::array<std::int64_t, 256>& counts) {
  const auto total = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  std::int64_t below = 0;
  int value = 0;
  while (value < 255 && 2 * (below + counts[value]) < total) below += counts[value++];
  const double within = (0.5 * static_cast<double>(total) - static_cast<double>(below)) /
                        static_cast<double>(std::max<std::int64_t>(counts[value], 1));
  return value == 0 ? 0.5 * within : value - 0.5 + within;
}

/// Whether a block shows something whose motion would be seen.
bool isTextured(const cv::Mat& grey, const cv::Rect& block, double noise) {
  constexpr double kClear = 3.0;  // times the noise
  constexpr int kStep = 2;
  std::int64_t sum = 0, count = 0;
  for (int y = block.y; y < block.y + block.height; y += kStep) {
    const auto* row = grey.ptr<std::uint8_t>(y);
    for (int x = block.x; x + kStep < block.x + block.width; ++x, ++count) sum += std::abs(row[x + kStep] - row[x]);
  }
  return static_cast<double>(sum) > kClear * noise * static_cast<double>(count);
}

}  // namespace

ViewImages::ViewImages(const cv::Mat& image, const cv::Mat& grey_image) : images{image} {
  const auto add = [this](const cv::Mat& other) {
    if (other.data == images.back().data) return;
    images.push_back(other);
  };
  add(grey_image);
  census = images.size() - 1;
  cv::Mat buffer;
  const cv::Mat& eight_bits = eightBitGrey(image, grey_image, buffer);
  if (eight_bits.data == image.data) return;
  add(eight_bits);
  grey = images.size() - 1;
}

void ViewAverage::start(const ViewImages& view) {
  planes_.resize(view.images.size());
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    view.images[i].convertTo(planes_[i].mean, CV_32F);
    view.images[i].copyTo(planes_[i].shown);
  }
  view.images[view.grey].copyTo(last_grey_);
  ages_.create(last_grey_.size(), CV_8UC1);
  ages_.setTo(1);
  pairs_ = 1;
}

bool ViewAverage::fits(const ViewImages& view) const {
  return std::equal(view.images.begin(), view.images.end(), planes_.begin(), planes_.end(),
                    [](const cv::Mat& image, const Plane& plane) {
                      return image.size() == plane.shown.size() && image.type() == plane.shown.type();
                    });
}

/// Standard deviation of the noise of one image, grey levels: what changes from pair to pair, at most about what the
/// plainest places of the image show.
double ViewAverage::measureNoise(const cv::Mat& grey) const {
  constexpr double kMedianOfNormal = 0.6745;
  constexpr double kCorrelated = 2.0;            // resampled noise is smooth
  constexpr int kDarkest = 2, kBrightest = 253;  // values beyond are cut off, and their noise with them
  std::array<std::int64_t, 256> counts{};
  for (int y = 0; y < grey.rows; ++y) {
    const auto* now = grey.ptr<std::uint8_t>(y);
    const auto* before = last_grey_.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) {
      if (before[x] < kDarkest || before[x] > kBrightest) continue;
      ++counts[std::abs(now[x] - before[x])];
    }
  }
  const double change = medianOf(counts) / (kMedianOfNormal * std::sqrt(2.0));
  const double seen = kCorrelated * measureQuality(grey).grain;
  return std::clamp(std::min(change, seen), kLeastNoise, kMostNoise);
}

/// A camera that moves changes most of what has texture.
bool ViewAverage::standsStill(const cv::Mat& grey, double noise) const {
  constexpr int kOneOf = 4;  // textured blocks
  int textured = 0, standing = 0;
  for (int y = 0; y + kBlockPx <= grey.rows; y += kBlockPx) {
    for (int x = 0; x + kBlockPx <= grey.cols; x += kBlockPx) {
      const cv::Rect block(x, y, kBlockPx, kBlockPx);
      if (!isTextured(grey, block, noise)) continue;
      ++textured;
      if (2 * cv::countNonZero(still_(block)) > block.area()) ++standing;
    }
  }
  return kOneOf * standing >= textured;
}

bool ViewAverage::compare(const ViewImages& view) {
  const cv::Mat& grey = view.images[view.grey];
  const double noise = measureNoise(grey);
  const cv::Mat squares = squaredChanges(grey, planes_[view.grey].mean);
  cv::Mat sums;
  cv::boxFilter(squares, sums, CV_32S, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_REFLECT_101);
  std::array<std::int32_t, kAges> limits{};
  for (int age = 1; age < kAges; ++age) {
    const double variance = noise * noise * kSubsteps * kSubsteps * (1.0 + 1.0 / age);
    limits[age] = static_cast<std::int32_t>(kMaxChange * kWindow * kWindow * variance);
  }
  still_.create(grey.size(), CV_8UC1);
  parallelFor(grey.rows, [&](int y) {
    const auto* sum = sums.ptr<std::int32_t>(y);
    const auto* age = ages_.ptr<std::uint8_t>(y);
    auto* still = still_.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) still[x] = sum[x] <= limits[age[x]] ? 255 : 0;
  });
  // A change that the window sees is wider than this.
  cv::morphologyEx(still_, still_, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8UC1));
  return standsStill(grey, noise);
}

template <typename Value>
bool ViewAverage::average(const cv::Mat& image, Plane& plane) const {
  const int count = image.cols * image.channels();
  const bool longest_follow = pairs_ % kPeriod == 0;
  std::vector<std::uint8_t> changed(image.rows, 0);
  const auto makeRow = [&] { return AgeRow(image.cols, image.channels()); };
  parallelFor(image.rows, makeRow, [&](int y, AgeRow& row) {
    const bool follows = row.fill(ages_.ptr<std::uint8_t>(y), image.cols, longest_follow);
    const auto* now = image.ptr<Value>(y);
    auto* mean = plane.mean.ptr<float>(y);
    for (int i = 0; i < count; ++i) mean[i] += (static_cast<float>(now[i]) - mean[i]) * row.weight[i];
    if (follows) changed[y] = showMeans(mean, row.follows.data(), count, plane.shown.ptr<Value>(y)) ? 1 : 0;
  });
  return std::find(changed.begin(), changed.end(), 1) != changed.end();
}

bool ViewAverage::take(const ViewImages& view) {
  ++pairs_;
  parallelFor(ages_.rows, [&](int y) {
    auto* age = ages_.ptr<std::uint8_t>(y);
    const auto* still = still_.ptr<std::uint8_t>(y);
    for (int x = 0; x < ages_.cols; ++x)
      age[x] = static_cast<std::uint8_t>(still[x] != 0 ? std::min(age[x] + 1, kLongest) : 1);
  });
  bool changed = false;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const cv::Mat& image = view.images[i];
    const bool eight_bits = image.depth() == CV_8U;
    if (eight_bits ? average<std::uint8_t>(image, planes_[i]) : average<std::uint16_t>(image, planes_[i])) {
      changed = true;
    }
  }
  view.images[view.grey].copyTo(last_grey_);
  return changed;
}

double ViewAverage::stillShare() const {
  return static_cast<double>(cv::countNonZero(ages_ > 1)) / static_cast<double>(ages_.total());
}

void TemporalAverage::steady(const cv::Mat& before, cv::Mat& disparity) const {
  constexpr float kSameSurface = 1.0F;  // px
  if (before.size() != disparity.size()) return;
  parallelFor(disparity.rows, [&](int y) {
    const auto* old = before.ptr<float>(y);
    auto* now = disparity.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      if (!(std::abs(now[x] - old[x]) <= kSameSurface) || !left_.stoodStill(x, y)) continue;
      const int match = static_cast<int>(std::lround(static_cast<float>(x) - now[x]));
      if (match < 0 || match >= disparity.cols || !right_.stoodStill(match, y)) continue;
      now[x] = old[x] + 0.5F * (now[x] - old[x]);
    }
  });
}

void TemporalAverage::reset(const std::string& reason) {
  if (!started_) return;
  started_ = false;
  reason_ = reason;
}

TemporalAverage::Outcome TemporalAverage::update(StereoPair& pair) {
  const ViewImages left(pair.left, pair.left_grey), right(pair.right, pair.right_grey);
  if (started_ && !(left_.fits(left) && right_.fits(right))) reset("images of another size or type");
  if (started_) {
    const bool left_stands = left_.compare(left), right_stands = right_.compare(right);
    if (!(left_stands && right_stands)) reset("the camera moves");
  }
  if (!started_) {
    left_.start(left);
    right_.start(right);
    started_ = true;
    return {0.0, true, reason_};
  }
  const bool left_changed = left_.take(left), right_changed = right_.take(right);
  pair = {left_.shown(0), right_.shown(0), left_.shown(left.census), right_.shown(right.census)};
  return {left_.stillShare(), left_changed || right_changed, ""};
}

}  // namespace fdp_stereo
