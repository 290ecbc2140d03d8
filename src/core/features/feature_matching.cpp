// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/feature_matching.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "features/corner_matching.hpp"
#include "features/patch_refinement.hpp"
#include "images/colour.hpp"
#include "parallel.hpp"

// OpenCV 4.2 has no SIFT in its main part; FDP_STEREO_FORCE_OPENCV_42 builds what is built there.
#if CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 404 && !defined(FDP_STEREO_FORCE_OPENCV_42)
#define FDP_STEREO_HAVE_SIFT
#endif

namespace fdp_stereo {
namespace {

/// A fit whose patches agree less is not of one point.
constexpr float kMinCorrelation = 0.8F;

/// OpenCV's pyramids fail on smaller images.
constexpr int kMinSidePx = 32;

void checkPair(const StereoPair& pair) {
  const int type = pair.left.type();
  if (pair.left.size() != pair.right.size() || type != pair.right.type() || (type != CV_8UC1 && type != CV_8UC3)) {
    throw std::invalid_argument("feature matching: the views must have one size and be 8-bit with 1 or 3 channels");
  }
}

struct Features {
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
};

cv::Ptr<cv::Feature2D> makeDetector(FeatureDetector detector, int max_features) {
#ifdef FDP_STEREO_HAVE_SIFT
  if (detector == FeatureDetector::kSift) return cv::SIFT::create(max_features);
#endif
  CV_Assert(detector == FeatureDetector::kOrb);
  return cv::ORB::create(max_features);
}

Features detect(const cv::Mat& grey, FeatureDetector detector, int max_features) {
  if (std::min(grey.rows, grey.cols) < kMinSidePx) return {};
  Features features;
  makeDetector(detector, max_features)->detectAndCompute(grey, cv::noArray(), features.points, features.descriptors);
  return features;
}

/// Old releases of OpenCV have no SIFT, and some builds have its interface without its algorithm: it throws here.
bool siftWorks() {
  static const bool works = [] {
    try {
      cv::Mat checks(32, 32, CV_8UC1, cv::Scalar(0));
      checks(cv::Rect(8, 8, 16, 16)).setTo(255);
      detect(checks, FeatureDetector::kSift, 10);
      return true;
    } catch (const cv::Exception&) {
      return false;
    }
  }();
  return works;
}

/// The two nearest neighbours of every feature of `from` in `to`; fewer where `to` has fewer.
std::vector<std::vector<cv::DMatch>> nearest(const Features& from, const Features& to, int norm, int count) {
  std::vector<std::vector<cv::DMatch>> found;
  if (!from.points.empty() && !to.points.empty()) {
    cv::BFMatcher(norm).knnMatch(from.descriptors, to.descriptors, found, count);
  }
  return found;
}

bool sameScale(const cv::KeyPoint& a, const cv::KeyPoint& b, double max_ratio) {
  return max_ratio <= 0.0 || std::max(a.size, b.size) <= max_ratio * std::min(a.size, b.size);
}

/// Paper eq. (10): the nearest descriptor, where it is clearly nearer than the second.
FeatureMatches matchDescriptors(const Features& left, const Features& right, const FeatureMatchingParams& params,
                                int norm) {
  const auto forward = nearest(left, right, norm, 2);
  const auto backward = params.mutual_check ? nearest(right, left, norm, 1) : std::vector<std::vector<cv::DMatch>>();
  FeatureMatches matches;
  for (const auto& candidates : forward) {
    if (candidates.size() < 2) continue;
    const cv::DMatch& best = candidates[0];
    const float ratio = best.distance / std::max(candidates[1].distance, 1e-6F);
    if (ratio > static_cast<float>(params.max_ratio)) continue;
    if (params.mutual_check && backward[best.trainIdx].front().trainIdx != best.queryIdx) continue;
    const cv::KeyPoint& p = left.points[best.queryIdx];
    const cv::KeyPoint& q = right.points[best.trainIdx];
    if (!sameScale(p, q, params.max_scale_ratio)) continue;
    matches.push_back({p.pt, q.pt, 1.0F - ratio});
  }
  return matches;
}

/// A match whose patches fit is moved to the pixel centre in the left view and to the fit in the right one; one whose
/// patches do not agree is dropped.
FeatureMatches refineMatches(const FeatureMatches& matches, const cv::Mat& left, const cv::Mat& right) {
  std::vector<PatchFit> fits(matches.size());
  const auto centreOf = [](const FeatureMatch& match) {
    return cv::Point(cvRound(match.left.x), cvRound(match.left.y));
  };
  parallelFor(static_cast<int>(matches.size()), [&](int i) {
    const cv::Point centre = centreOf(matches[i]);
    fits[i] = fitPatch(left, right, centre, matches[i].right + (cv::Point2f(centre) - matches[i].left));
  });
  FeatureMatches refined;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].converged || fits[i].correlation < kMinCorrelation) continue;
    refined.push_back({cv::Point2f(centreOf(matches[i])), fits[i].right, matches[i].trust});
  }
  return refined;
}

bool allowed(const FeatureMatch& match, DisparityRange range, double max_row_difference_px) {
  return range.contains(match.disparity()) && std::abs(match.rowResidual()) <= max_row_difference_px;
}

/// One match per left position, in raster order.
void sortAndUnite(FeatureMatches& matches) {
  const auto key = [](const FeatureMatch& m) { return std::make_tuple(m.left.y, m.left.x, m.right.y, m.right.x); };
  std::sort(matches.begin(), matches.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  matches.erase(
      std::unique(matches.begin(), matches.end(), [](const auto& a, const auto& b) { return a.left == b.left; }),
      matches.end());
}

}  // namespace

FeatureMatching matchFeatures(const StereoPair& pair, DisparityRange range, const FeatureMatchingParams& params) {
  checkPair(pair);
  FeatureMatching result;
  result.detector = params.detector;
  if (params.detector == FeatureDetector::kSift && !siftWorks()) {
    result.detector = FeatureDetector::kOrb;
    result.note = "this build of OpenCV has no SIFT: matched with ORB";
  }
  cv::Mat made_left, made_right;
  const cv::Mat& left = eightBitGrey(pair.left, pair.left_grey, made_left);
  const cv::Mat& right = eightBitGrey(pair.right, pair.right_grey, made_right);
  if (result.detector == FeatureDetector::kFastCensus) {
    for (const CornerMatch& m : matchCorners(left, right, range, params)) {
      result.matches.push_back({cv::Point2f(m.left), cv::Point2f(m.right), 1.0F - m.ratio});
    }
  } else {
    const int norm = result.detector == FeatureDetector::kSift ? cv::NORM_L2 : cv::NORM_HAMMING;
    result.matches = matchDescriptors(detect(left, result.detector, params.max_features),
                                      detect(right, result.detector, params.max_features), params, norm);
  }
  if (params.refine) result.matches = refineMatches(result.matches, left, right);
  const auto wrong = [&](const FeatureMatch& m) { return !allowed(m, range, params.max_row_difference_px); };
  result.matches.erase(std::remove_if(result.matches.begin(), result.matches.end(), wrong), result.matches.end());
  sortAndUnite(result.matches);
  return result;
}

}  // namespace fdp_stereo
