// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/free_space.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "fdp_stereo/io.hpp"
#include "fdp_stereo/types.hpp"

namespace fdp_stereo {
namespace {

constexpr float kMarginPx = 1.0F;       ///< by which an answer that is right may be off
constexpr double kAnsweredShare = 0.9;  ///< of the pixels of a known square
constexpr double kLargestBulge = 0.8;   ///< of the depth
constexpr float kNothing = -1.0F;       ///< below every disparity that has a depth

/// A square of the grid.
struct Squares {
  cv::Mat nearest;  ///< CV_32FC1 px: of the answers in and around it, kNothing for none
  cv::Mat known;    ///< CV_8UC1: 255 where its pixels are answered
};

Squares summarize(const cv::Mat& disparity, const cv::Mat& trusted, int spacing) {
  cv::Mat answers;
  cv::max(disparity, 0.0, answers);  // beyond infinity is infinitely far
  const cv::Mat none = noneMask(disparity);
  answers.setTo(kNothing, none);
  cv::Mat evidence = ~none;
  if (!trusted.empty()) evidence.setTo(0, trusted == 0);
  const cv::Rect image({0, 0}, disparity.size());
  const cv::Size grid((disparity.cols + spacing - 1) / spacing, (disparity.rows + spacing - 1) / spacing);
  Squares squares{cv::Mat(grid, CV_32FC1), cv::Mat(grid, CV_8UC1)};
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const cv::Rect square = cv::Rect(x * spacing, y * spacing, spacing, spacing) & image;
      const cv::Rect around = cv::Rect((x - 1) * spacing, (y - 1) * spacing, 3 * spacing, 3 * spacing) & image;
      double nearest = 0.0;
      cv::minMaxLoc(answers(around), nullptr, &nearest);
      squares.nearest.at<float>(y, x) = static_cast<float>(nearest);
      const bool known = cv::countNonZero(evidence(square)) >= kAnsweredShare * square.area();
      squares.known.at<std::uint8_t>(y, x) = known ? 255 : 0;
    }
  }
  return squares;
}

/// What known squares at both ends of a gap of a row tell of the gap.
void fillGap(const float* nearest, int first, int last, double focal_px, int spacing, float* free) {
  const float near = *std::max_element(nearest + first - 1, nearest + last + 2);
  const double bulge = (last - first + 1) * spacing / (2.0 * focal_px);  // of the depth
  if (bulge > kLargestBulge) return;
  std::fill(free + first, free + last + 1, static_cast<float>((near + kMarginPx) / (1.0 - bulge)));
}

/// The gaps between known squares along the rows; NaN elsewhere.
cv::Mat enclosedAlongRows(const Squares& squares, double focal_px, int spacing) {
  cv::Mat free(squares.known.size(), CV_32FC1, cv::Scalar(kInvalidDisparity));
  for (int y = 0; y < free.rows; ++y) {
    const auto* known = squares.known.ptr<std::uint8_t>(y);
    int last_known = -1;
    for (int x = 0; x < free.cols; ++x) {
      if (known[x] == 0) continue;
      if (last_known >= 0 && x - last_known > 1) {
        fillGap(squares.nearest.ptr<float>(y), last_known + 1, x - 1, focal_px, spacing, free.ptr<float>(y));
      }
      last_known = x;
    }
  }
  return free;
}

}  // namespace

cv::Mat freeDisparity(const cv::Mat& disparity, const cv::Mat& trusted, double focal_px, int spacing) {
  const Squares squares = summarize(disparity, trusted, spacing);
  cv::Mat free = enclosedAlongRows(squares, focal_px, spacing);
  const cv::Mat along_columns = enclosedAlongRows({squares.nearest.t(), squares.known.t()}, focal_px, spacing).t();
  for (int y = 0; y < free.rows; ++y) {
    for (int x = 0; x < free.cols; ++x) {
      float& value = free.at<float>(y, x);
      value = std::fmax(value, along_columns.at<float>(y, x));
      if (squares.known.at<std::uint8_t>(y, x) != 0) value = squares.nearest.at<float>(y, x) + kMarginPx;
    }
  }
  return free;
}

cv::Point rayPixel(cv::Point square, int spacing, cv::Size image) {
  return {std::min(square.x * spacing + spacing / 2, image.width - 1),
          std::min(square.y * spacing + spacing / 2, image.height - 1)};
}

}  // namespace fdp_stereo
