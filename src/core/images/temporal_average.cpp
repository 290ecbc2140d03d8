// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/temporal_average.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "images/colour.hpp"
#include "images/view_change.hpp"
#include "parallel.hpp"

namespace fdp_stereo {
namespace {

constexpr int kLongest = 16;  // pairs in a mean; beyond them the old ones fade
constexpr int kAges = kLongest + 1;
constexpr int kPeriod = 8;          // pairs after which what is shown of a mean that is this long follows it
constexpr int kWindow = 7;          // px, side of the window whose change is compared with the noise
constexpr double kMaxChange = 2.5;  // of the variance of the noise there; more is no noise
constexpr int kBlockPx = 16;        // side of the blocks that tell whether the camera stands
constexpr float kRounding = 0.5F;   // of what becomes whole

/// Whether what is shown follows a mean of so many pairs: 1, 2, 3, 4, 6, 8, 12. Between these steps a still view is the
/// same to the bit.
bool isStep(int age) {
  const auto powerOfTwo = [](int n) { return (n & (n - 1)) == 0; };
  return powerOfTwo(age) || (age % 3 == 0 && powerOfTwo(age / 3));
}

/// Which means are followed by what is shown beside those at a step.
struct Follow {
  bool longest, all;
};

/// What the age of a pixel says, for every channel of a row.
struct AgeRow {
  AgeRow(int cols, int count_per_pixel)
      : channels(count_per_pixel), weight(cols * count_per_pixel), follows(cols * count_per_pixel) {}

  /// Returns whether anything of the row follows its mean.
  bool fill(const std::uint8_t* ages, int cols, const Follow& follow) {
    std::array<float, kAges> weights{};
    std::array<std::uint8_t, kAges> steps{};
    for (int age = 1; age < kAges; ++age) {
      weights[age] = 1.0F / static_cast<float>(age);
      steps[age] = follow.all || (age < kLongest ? isStep(age) : follow.longest) ? 1 : 0;
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
  constexpr float kLargest = std::numeric_limits<Value>::max();
  int changes = 0;
  for (int i = 0; i < count; ++i) {
    const auto mean = static_cast<Value>(std::min(means[i] + kRounding, kLargest));  // brighter light may pass it
    const auto value = follows[i] != 0 ? mean : shown[i];
    changes += value != shown[i] ? 1 : 0;
    shown[i] = value;
  }
  return changes > 0;
}

/// Sums of the squares in the window around every pixel.
cv::Mat squaresAround(const cv::Mat& changes) {
  cv::Mat squares, sums;
  cv::multiply(changes, changes, squares, 1.0, CV_16U);
  cv::boxFilter(squares, sums, CV_32S, {kWindow, kWindow}, {-1, -1}, false, cv::BORDER_REFLECT_101);
  return sums;
}

/// Whether a block shows something whose motion would be seen.
bool isTextured(const cv::Mat& grey, const cv::Rect& block, const NoiseLevels& noise) {
  constexpr double kClear = 3.0;  // times the noise
  constexpr int kStep = 2;
  std::int64_t sum = 0, values = 0, count = 0;
  for (int y = block.y; y < block.y + block.height; y += kStep) {
    const auto* row = grey.ptr<std::uint8_t>(y);
    for (int x = block.x; x + kStep < block.x + block.width; ++x, ++count) {
      sum += std::abs(row[x + kStep] - row[x]);
      values += row[x];
    }
  }
  const int average = static_cast<int>(values / std::max<std::int64_t>(count, 1));
  return static_cast<double>(sum) > kClear * noise[noiseLevel(average)] * static_cast<double>(count);
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

/// Light that changes everywhere is no motion: the means follow it. Returns how much brighter the grey image is.
double ViewAverage::followLight(const ViewImages& view) {
  constexpr double kSteady = 0.002;  // of the brightness: less is not seen
  double light = 1.0;
  relit_ = false;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const double ratio = brightnessRatio(view.images[i], planes_[i].mean);
    if (std::abs(ratio - 1.0) < kSteady) continue;
    planes_[i].mean *= ratio;
    relit_ = true;
    if (i == view.grey) light = ratio;
  }
  return light;
}

/// A camera that moves changes most of what has texture.
bool ViewAverage::standsStill(const cv::Mat& grey, const NoiseLevels& noise) const {
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
  const double light = followLight(view);
  const cv::Mat& grey = view.images[view.grey];
  const cv::Mat changes = changesFrom(planes_[view.grey].mean, grey);
  const NoiseLevels noise = measureNoise(grey, last_grey_, light);
  const cv::Mat sums = squaresAround(changes);
  std::array<std::array<std::int32_t, kAges>, noise.size()> limits{};
  for (std::size_t level = 0; level < noise.size(); ++level) {
    const double variance = noise[level] * noise[level] * kChangeSteps * kChangeSteps;
    for (int age = 1; age < kAges; ++age) {
      limits[level][age] = static_cast<std::int32_t>(kMaxChange * kWindow * kWindow * variance * (1.0 + 1.0 / age));
    }
  }
  still_.create(grey.size(), CV_8UC1);
  parallelFor(grey.rows, [&](int y) {
    const auto* sum = sums.ptr<std::int32_t>(y);
    const auto* value = grey.ptr<std::uint8_t>(y);
    const auto* age = ages_.ptr<std::uint8_t>(y);
    auto* still = still_.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) still[x] = sum[x] <= limits[noiseLevel(value[x])][age[x]] ? 255 : 0;
  });
  // A change that the window sees is wider than this.
  cv::morphologyEx(still_, still_, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8UC1));
  return standsStill(grey, noise);
}

template <typename Value>
bool ViewAverage::average(const cv::Mat& image, Plane& plane) const {
  const int count = image.cols * image.channels();
  const Follow follow{pairs_ % kPeriod == 0, relit_};
  std::vector<std::uint8_t> changed(image.rows, 0);
  const auto makeRow = [&] { return AgeRow(image.cols, image.channels()); };
  parallelFor(image.rows, makeRow, [&](int y, AgeRow& row) {
    const bool follows = row.fill(ages_.ptr<std::uint8_t>(y), image.cols, follow);
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
    if (!(left_stands && right_stands)) reset("the view changed");
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
