// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "fdp_stereo/feature_matching.hpp"
#include "fdp_stereo/image_preparation.hpp"
#include "fdp_stereo/row_alignment.hpp"
#include "search_range.hpp"
#include "stamps.hpp"

namespace fdp_stereo {
namespace {

using Findings = std::vector<Finding>;

constexpr double kEnoughInStep = 0.9;      ///< of the left images
constexpr double kOddRowOffsetPx = 0.3;    ///< costs accuracy
constexpr double kWrongRowOffsetPx = 1.0;  ///< costs the disparity
constexpr std::size_t kEnoughMatches = 30;
constexpr double kOutsideRange = 0.05;  ///< of the matches
constexpr double kManyBeyond = 0.1;     ///< of the matches; wrong ones are fewer
constexpr double kUnequalRates = 1.3;   ///< messages of one topic per message of the other

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

/// How two topics meet in time; the slower one is asked.
struct Meeting {
  double share = 0.0;    ///< of the stamps of the slower topic that the other one has too
  double apart_s = 0.0;  ///< median distance to the nearest stamp of the other
  bool unequal_rates = false;
};

Meeting meetingOf(const std::vector<ros::Time>& a, const std::vector<ros::Time>& b) {
  const auto& slow = a.size() <= b.size() ? a : b;
  const auto& fast = a.size() <= b.size() ? b : a;
  std::vector<double> distances;
  for (const ros::Time& stamp : slow) distances.push_back(nearest(fast, stamp));
  std::sort(distances.begin(), distances.end());
  const auto met = std::count(distances.begin(), distances.end(), 0.0);
  const auto count = static_cast<double>(slow.size());
  return {static_cast<double>(met) / count, distances[distances.size() / 2],
          static_cast<double>(fast.size()) > kUnequalRates * count && fast.size() > slow.size() + 2};
}

/// Stamps that do not meet, as far as the node does not put up with it.
Finding judgeApart(const Observation& seen, const std::string& told, double apart_s) {
  const auto slowest = std::min_element(seen.inputs.begin(), seen.inputs.end(), [](const auto& a, const auto& b) {
                         return a.stamps.size() < b.stamps.size();
                       })->stamps.size();
  if (seen.approximate_sync && seen.disparities > 0) {
    return {Verdict::kGood, told + ", which approximate_sync puts up with", ""};
  }
  if (seen.approximate_sync) {
    const bool too_far = seen.tolerance_s > 0.0 && apart_s > seen.tolerance_s;
    return {Verdict::kWrong, told,
            too_far ? text("synchronise the cameras better, or start stereo.launch with approximate_sync_tolerance "
                           "above ",
                           apart_s, " s")
                    : "start stereo.launch with a larger queue_size"};
  }
  if (2 * seen.disparities > slowest) {
    return {Verdict::kOdd, told + "; disparities come all the same, so they were lost on the way to this program",
            "look at the load of the machine and its network"};
  }
  return {Verdict::kWrong, told,
          "trigger the cameras together and give camera_info the stamp of its image, or start stereo.launch with "
          "approximate_sync:=true"};
}

void checkStamps(const Observation& seen, Findings& findings) {
  const TopicObservation& left = seen.inputs[0];
  for (std::size_t i = 1; i < seen.inputs.size(); ++i) {
    const TopicObservation& other = seen.inputs[i];
    const Meeting meeting = meetingOf(left.stamps, other.stamps);
    if (meeting.unequal_rates) {
      const TopicObservation& slower = other.stamps.size() < left.stamps.size() ? other : left;
      findings.push_back({Verdict::kOdd,
                          text("the rates differ: ", left.stamps.size(), " messages of ", left.topic, " and ",
                               other.stamps.size(), " of ", other.topic, " in ", seen.seconds, " s"),
                          "no more pairs than messages of " + slower.topic +
                              " can come out: let the driver, or throttle, give all four topics one rate"});
    }
    if (meeting.share >= kEnoughInStep) continue;
    findings.push_back(judgeApart(seen,
                                  text("only ", 100.0 * meeting.share, " % of the stamps of ", left.topic, " and ",
                                       other.topic, " are equal; they are ", 1e3 * meeting.apart_s, " ms apart"),
                                  meeting.apart_s));
  }
}

/// A pair that can be used.
struct CheckedPair {
  StereoPair images;  ///< as the stages see them
  StereoGeometry geometry;
};

std::optional<CheckedPair> checkPair(const Observation& seen, Findings& findings) {
  const StereoFrame& frame = *seen.pair;
  const StereoTopics topics{seen.inputs[0].topic, seen.inputs[2].topic, seen.inputs[1].topic, seen.inputs[3].topic};
  try {
    const cv::Mat left = decodeImage(*frame.left, topics.left_image);
    const cv::Mat right = decodeImage(*frame.right, topics.right_image);
    std::vector<std::string> warnings;
    const StereoGeometry geometry = stereoGeometry(*frame.left_info, *frame.right_info, left.size(), topics, warnings);
    for (const std::string& warning : warnings) {
      findings.push_back({Verdict::kOdd, warning, "mend camera_info, or calibrate the pair anew"});
    }
    findings.push_back({Verdict::kGood,
                        text(left.cols, " x ", left.rows, " px ", frame.left->encoding, ", f = ", geometry.focal_px,
                             " px, baseline ", geometry.baseline_m, " m"),
                        ""});
    return CheckedPair{prepareImages(left, right), geometry};
  } catch (const std::invalid_argument& error) {
    const std::string told = error.what();  // begins with the topic
    findings.push_back(
        {Verdict::kWrong, told, "look: rostopic echo -n 1 --noarr " + told.substr(0, told.find_first_of(": "))});
    return std::nullopt;
  }
}

/// Both signs, so that exchanged views are found too.
FeatureMatches matchWidely(const StereoPair& pair) {
  FeatureMatchingParams params;
  params.detector = FeatureDetector::kSift;
  params.max_ratio = 0.7;
  params.max_row_difference_px = 8.0;
  const int half = pair.left.cols / 2;
  return matchFeatures(pair, {-half, 2 * half + 1}, params).matches;
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

std::vector<float> sortedDisparities(const FeatureMatches& matches) {
  std::vector<float> disparities;
  for (const FeatureMatch& match : matches) disparities.push_back(match.disparity());
  std::sort(disparities.begin(), disparities.end());
  return disparities;
}

/// Share of the disparities that only things beyond infinity would have; sign -1: if the images were exchanged.
double shareBeyondInfinity(const std::vector<float>& disparities, const StereoGeometry& geometry, float sign) {
  constexpr double kBeyondPx = -1.0;
  const auto beyond = std::count_if(disparities.begin(), disparities.end(),
                                    [&](float d) { return geometry.published(sign * d) < kBeyondPx; });
  return static_cast<double>(beyond) / static_cast<double>(disparities.size());
}

/// False where the images were exchanged: much of the scene would lie beyond infinity, and the other way round it does
/// not. With principal points that differ, not all of it need do so.
bool checkViews(const std::vector<float>& disparities, const StereoGeometry& geometry, const Observation& seen,
                Findings& findings) {
  const double as_is = shareBeyondInfinity(disparities, geometry, 1.0F);
  const double exchanged = shareBeyondInfinity(disparities, geometry, -1.0F);
  if (as_is < kManyBeyond || exchanged > as_is / 4.0) return true;
  findings.push_back({Verdict::kWrong,
                      text("left and right images are swapped: ", 100.0 * as_is,
                           " % of the matches have a disparity that only things beyond infinity would have"),
                      "exchange " + seen.inputs[0].topic + " and " + seen.inputs[2].topic +
                          " (cables, device names or remappings); camera_info is in order"});
  return false;
}

std::string rangeCommand(const std::string& node, double first, double last) {
  constexpr int kMargin = 4;
  const int min = static_cast<int>(std::floor(first)) - kMargin;
  const int count = static_cast<int>(std::ceil(last)) + kMargin - min + 1;
  return text("rosrun dynamic_reconfigure dynparam set ", node, " \"{min_disparity: ", min,
              ", disparity_range: ", count, "}\"");
}

void checkMatches(const std::vector<float>& disparities, const Observation& seen, Findings& findings) {
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
  } else {
    findings.push_back({Verdict::kWrong, told, rangeCommand(seen.node, at(0.02), at(0.98))});
  }
}

/// The range without the scene: what it can see at all.
void checkVisible(const CheckedPair& pair, const Observation& seen, Findings& findings) {
  const int width = pair.images.left.cols;
  try {
    std::vector<std::string> warnings;
    checkRange(seen.range, width, pair.geometry, warnings);
    for (const std::string& warning : warnings) {
      findings.push_back({Verdict::kOdd, warning, "see docs/tuning.md: the range of disparities"});
    }
    findings.push_back({Verdict::kGood, visibleDistances(seen.range, width, pair.geometry), ""});
    findings.push_back({Verdict::kGood, depthErrors(kTypicalSigmaPx, pair.geometry), ""});
  } catch (const std::invalid_argument& error) {
    findings.push_back({Verdict::kWrong, error.what(), rangeCommand(seen.node, 0.0, 63.0)});
  }
}

void checkScene(const CheckedPair& pair, const Observation& seen, Findings& findings) {
  checkVisible(pair, seen, findings);
  const FeatureMatches matches = matchWidely(pair.images);
  if (matches.size() < kEnoughMatches) {
    findings.push_back({Verdict::kOdd, text("only ", matches.size(), " matches between the views"),
                        "show the cameras something with texture, and check focus, exposure and that both see it"});
    return;
  }
  checkRows(matches, pair.images.left.size(), findings);
  const std::vector<float> disparities = sortedDisparities(matches);
  if (checkViews(disparities, pair.geometry, seen, findings)) checkMatches(disparities, seen, findings);
}

void checkOutput(const Observation& seen, Findings& findings) {
  const bool faulty =
      std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.verdict == Verdict::kWrong; });
  if (seen.disparities > 0) {
    findings.push_back(
        {Verdict::kGood, text("disparity: ", static_cast<double>(seen.disparities) / seen.seconds, " Hz"), ""});
  } else if (seen.disparity_publishers == 0) {
    findings.push_back(
        {Verdict::kWrong, seen.node + " does not run: nobody publishes disparity",
         "start it: roslaunch fdp_stereo stereo.launch; a nodelet manager that was started anew has lost "
         "its nodelets"});
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
