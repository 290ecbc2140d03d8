// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/row_alignment.hpp"

namespace fdp_stereo {
namespace {

constexpr double kArrowScale = 40.0;
constexpr double kLongestArrowPx = 1.0;  // of residual: wrong matches would cross the picture

cv::Mat toEightBitBgr(const cv::Mat& image) {
  const cv::Mat result = toEightBit(image);
  if (result.channels() == 3) return result.clone();
  cv::Mat colour;
  cv::cvtColor(result, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

/// Half grey value, half red (positive) or blue.
cv::Vec3b tint(const cv::Vec3b& pixel, double share) {
  const double grey = (pixel[0] + pixel[1] + pixel[2]) / 6.0;
  const double strength = 127.0 * std::clamp(std::abs(share), 0.0, 1.0);
  const double red = share > 0.0 ? strength : 0.0;
  const double blue = share > 0.0 ? 0.0 : strength;
  return {cv::saturate_cast<uchar>(grey + blue), cv::saturate_cast<uchar>(grey), cv::saturate_cast<uchar>(grey + red)};
}

void drawArrow(cv::Mat& picture, const FeatureMatch& match, const RowOffsetModel& model) {
  const double residual = match.rowResidual() - model.offsetAt(match.right.x, match.left.y);
  const bool wrong = std::abs(residual) > kLongestArrowPx;
  const double length = kArrowScale * std::clamp(residual, -kLongestArrowPx, kLongestArrowPx);
  const cv::Point from(cvRound(match.left.x), cvRound(match.left.y));
  const cv::Point to(from.x, cvRound(match.left.y + length));
  const cv::Scalar colour = wrong ? cv::Scalar(160, 160, 160) : cv::Scalar(80, 255, 80);
  if (from == to) {
    cv::circle(picture, from, 1, colour, cv::FILLED, cv::LINE_AA);
  } else {
    cv::arrowedLine(picture, from, to, colour, 1, cv::LINE_AA, 0, 0.3);
  }
}

}  // namespace

cv::Mat drawRowAlignment(const cv::Mat& left, const FeatureMatches& matches, const RowAlignment& alignment,
                         double full_scale_px) {
  cv::Mat picture = toEightBitBgr(left);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      pixel = tint(pixel, alignment.model.offsetAt(x, y) / full_scale_px);
    }
  }
  for (const FeatureMatch& match : matches) drawArrow(picture, match, alignment.model);
  const std::string text = alignment.note;
  cv::putText(picture, text, {6, picture.rows - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(0), 3, cv::LINE_AA);
  cv::putText(picture, text, {6, picture.rows - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(255), 1,
              cv::LINE_AA);
  return picture;
}

}  // namespace fdp_stereo
