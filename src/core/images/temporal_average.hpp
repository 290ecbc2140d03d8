// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fdp_stereo/types.hpp"
#include "images/view_change.hpp"

namespace fdp_stereo {

/// The images of one view that are not one and the same.
struct ViewImages {
  ViewImages(const cv::Mat& image, const cv::Mat& grey);
  std::vector<cv::Mat> images;  ///< that for the colours first
  std::size_t census = 0;       ///< which of them is the grey one in its full depth
  std::size_t grey = 0;         ///< and which the one of CV_8UC1
};

/// The images of one view, averaged where they stand still.
class ViewAverage {
 public:
  /// Begins anew and shows the images as they are.
  void start(const ViewImages& view);
  bool fits(const ViewImages& view) const;
  /// Looks which pixels stand still; returns whether the camera does.
  bool compare(const ViewImages& view);
  /// Takes the images that were compared. Returns whether what is shown changed.
  bool take(const ViewImages& view);

  const cv::Mat& shown(std::size_t image) const { return planes_[image].shown; }
  double stillShare() const;
  bool stoodStill(int x, int y) const { return ages_.at<std::uint8_t>(y, x) > 1; }

 private:
  /// One image: its mean (CV_32F) and what is shown of that, in the type of the image.
  struct Plane {
    cv::Mat mean, shown;
  };
  double followLight(const ViewImages& view);
  bool standsStill(const cv::Mat& grey, const NoiseLevels& noise) const;
  template <typename Value>
  bool average(const cv::Mat& image, Plane& plane) const;

  std::vector<Plane> planes_;
  std::int64_t pairs_ = 0;  ///< since start()
  bool relit_ = false;      ///< the light changed since the pair before
  cv::Mat last_grey_;
  cv::Mat ages_;   ///< CV_8UC1: for how many pairs a pixel has stood still, from 1
  cv::Mat still_;  ///< CV_8UC1, 255 where compare() found no change
};

/// Averages both views of a stream.
class TemporalAverage {
 public:
  /// What became of a pair.
  struct Outcome {
    double kept_share = 0.0;
    bool changed = true;  ///< the pair as it is now differs from the one before
    std::string reset;    ///< why it is as it was given; empty where something was averaged
  };
  /// Replaces the images of the pair by what is to be matched.
  Outcome update(StereoPair& pair);
  /// Meets the disparities of the pair before half way where they are of what stands still in both views and differ by
  /// up to 1 px. Maps of the size of the images; none before, or after a reset: nothing is changed.
  void steady(const cv::Mat& before, cv::Mat& disparity) const;
  /// The next pair is the first one.
  void reset(const std::string& reason);

 private:
  bool started_ = false;
  std::string reason_ = "first pair";
  ViewAverage left_, right_;
};

}  // namespace fdp_stereo
