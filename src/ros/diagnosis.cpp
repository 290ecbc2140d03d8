// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "fdp_stereo/feature_matching.hpp"
#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/row_alignment.hpp"
#include "stamps.hpp"

namespace fdp_stereo {
namespace {

using Findings = std::vector<Finding>;

constexpr double kEnoughInStep = 0.9;      ///< of the left images
constexpr double kOddRowOffsetPx = 0.3;    ///< costs accuracy
constexpr double kWrongRowOffsetPx = 1.0;  ///< costs the disparity
constexpr std::size_t kEnoughMatches = 30;
constexpr double kOutsideRange = 0.05;  ///< of the matches

template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  stream.precision(3);
  (stream << ... << parts);
  return stream.str();
}

bool checkTopics(const Observation& seen, Findings& findings) {
  bool all = true;
  for (const TopicObservation& input : seen.inputs) {
    if (!input.stamps.empty()) {
      findings.push_back({Verdict::kGood,
                          text(input.topic, ": ", static_cast<double>(input.stamps.size()) / seen.seconds, " Hz"), ""});
      continue;
    }
    all = false;
    if (input.publishers == 0) {
      findings.push_back({Verdict::kWrong, input.topic + " has no publisher",
                          "find the right name with: rostopic list; then remap it, or start the driver or image_proc"});
    } else {
      findings.push_back(
          {Verdict::kWrong, input.topic + " has a publisher that sent nothing",
           "the node that publishes it gets no images or camera_info itself; see which it is: rostopic info " +
               input.topic});
    }
  }
  return all;
}

/// Distance in time to the nearest stamp, s.
double nearest(const std::vector<ros::Time>& stamps, const ros::Time& stamp) {
  double best = 1e9;
  for (const ros::Time& other : stamps) best = std::min(best, std::abs(secondsBetween(other, stamp)));
  return best;
}

void checkStamps(const Observation& seen, Findings& findings) {
  for (std::size_t i = 1; i < seen.inputs.size(); ++i) {
    const auto& left = seen.inputs[0].stamps;
    const std::set<ros::Time> other(seen.inputs[i].stamps.begin(), seen.inputs[i].stamps.end());
    const auto met = std::count_if(left.begin(), left.end(), [&](const ros::Time& t) { return other.count(t) > 0; });
    const double share = static_cast<double>(met) / static_cast<double>(left.size());
    if (share >= kEnoughInStep) continue;
    const double apart_ms = 1e3 * nearest(seen.inputs[i].stamps, left[left.size() / 2]);
    findings.push_back({Verdict::kWrong,
                        text("only ", 100.0 * share, " % of the stamps of ", seen.inputs[0].topic, " are met by ",
                             seen.inputs[i].topic, "; the nearest is ", apart_ms, " ms away"),
                        "trigger the cameras together, or start stereo.launch with approximate_sync:=true"});
  }
}

/// The images as the stages see them, where images and calibration can be used.
std::optional<StereoPair> checkPair(const Observation& seen, Findings& findings) {
  const StereoFrame& frame = *seen.pair;
  const StereoTopics topics{seen.inputs[0].topic, seen.inputs[2].topic, seen.inputs[1].topic, seen.inputs[3].topic};
  try {
    const cv::Mat left = decodeImage(*frame.left, topics.left_image);
    const cv::Mat right = decodeImage(*frame.right, topics.right_image);
    std::vector<std::string> warnings;
    const StereoGeometry geometry = stereoGeometry(*frame.left_info, *frame.right_info, left.size(), topics, warnings);
    for (const std::string& warning : warnings) {
      findings.push_back({Verdict::kOdd, warning, "use the two files of one stereo calibration"});
    }
    findings.push_back({Verdict::kGood,
                        text(left.cols, " x ", left.rows, " px ", frame.left->encoding, ", f = ", geometry.focal_px,
                             " px, baseline ", geometry.baseline_m, " m"),
                        ""});
    return prepareImages(left, right);
  } catch (const std::invalid_argument& error) {
    const std::string told = error.what();  // begins with the topic
    findings.push_back(
        {Verdict::kWrong, told, "look: rostopic echo -n 1 --noarr " + told.substr(0, told.find_first_of(": "))});
    return std::nullopt;
  }
}

FeatureMatches matchWidely(const StereoPair& pair) {
  FeatureMatchingParams params;
  params.detector = FeatureDetector::kSift;
  params.max_ratio = 0.7;
  params.max_row_difference_px = 8.0;
  const int half = pair.left.cols / 2;
  return matchFeatures(pair, {-half / 4, half + half / 4}, params).matches;
}

void checkRows(const FeatureMatches& matches, cv::Size size, Findings& findings) {
  const RowAlignment rows = estimateRowAlignment(matches, size, {});
  const double off = std::max(rows.offset_rms_px, rows.rms_before_px);
  const std::string told = text("rows of the two images are off by ", off, " px (", matches.size(), " matches)");
  if (off > kWrongRowOffsetPx) {
    findings.push_back({Verdict::kWrong, told, "calibrate anew: rosrun camera_calibration cameracalibrator.py"});
  } else if (off > kOddRowOffsetPx) {
    findings.push_back({Verdict::kOdd, told, "keep row_alignment_enabled true, and calibrate anew when you can"});
  } else {
    findings.push_back({Verdict::kGood, told, ""});
  }
}

void checkRange(const FeatureMatches& matches, const Observation& seen, Findings& findings) {
  std::vector<float> disparities;
  for (const FeatureMatch& match : matches) disparities.push_back(match.disparity());
  std::sort(disparities.begin(), disparities.end());
  const auto at = [&](double share) {
    return disparities[static_cast<std::size_t>(share * static_cast<double>(disparities.size() - 1))];
  };
  const auto outside =
      std::count_if(disparities.begin(), disparities.end(), [&](float d) { return !seen.range.contains(d); });
  const double share = static_cast<double>(outside) / static_cast<double>(disparities.size());
  const std::string told = text(100.0 * share, " % of the matches lie outside the searched ", seen.range.min, " to ",
                                seen.range.max(), " px; the scene has ", at(0.02), " to ", at(0.98), " px");
  if (share <= kOutsideRange) {
    findings.push_back({Verdict::kGood, told, ""});
    return;
  }
  constexpr int kMargin = 4;
  const int min = static_cast<int>(std::floor(at(0.02))) - kMargin;
  const int count = static_cast<int>(std::ceil(at(0.98))) + kMargin - min + 1;
  findings.push_back({Verdict::kWrong, told,
                      text("rosrun dynamic_reconfigure dynparam set ", seen.node, " \"{min_disparity: ", min,
                           ", disparity_range: ", count, "}\"")});
}

void checkScene(const StereoPair& pair, const Observation& seen, Findings& findings) {
  const FeatureMatches matches = matchWidely(pair);
  if (matches.size() < kEnoughMatches) {
    findings.push_back({Verdict::kOdd, text("only ", matches.size(), " matches between the views"),
                        "show the cameras something with texture, and check focus, exposure and that both see it"});
    return;
  }
  checkRows(matches, pair.left.size(), findings);
  checkRange(matches, seen, findings);
}

void checkOutput(const Observation& seen, Findings& findings) {
  const bool faulty =
      std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.verdict == Verdict::kWrong; });
  if (seen.disparities > 0) {
    findings.push_back(
        {Verdict::kGood, text("disparity: ", static_cast<double>(seen.disparities) / seen.seconds, " Hz"), ""});
  } else if (seen.disparity_publishers == 0) {
    findings.push_back({Verdict::kWrong, seen.node + " does not run: nobody publishes disparity",
                        "start it: roslaunch fdp_stereo stereo.launch"});
  } else if (faulty) {
    findings.push_back({Verdict::kWrong, "no disparity came from " + seen.node, "cure what is WRONG above first"});
  } else {
    findings.push_back({Verdict::kWrong, "no disparity came from " + seen.node,
                        "read its log, and what it says of itself: rostopic echo /diagnostics"});
  }
}

}  // namespace

std::vector<Finding> diagnose(const Observation& observation) {
  Findings findings;
  if (checkTopics(observation, findings)) {
    checkStamps(observation, findings);
    if (observation.pair) {
      if (const auto pair = checkPair(observation, findings)) checkScene(*pair, observation, findings);
    }
  }
  checkOutput(observation, findings);
  return findings;
}

}  // namespace fdp_stereo
