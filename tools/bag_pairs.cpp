// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "stamps.hpp"

namespace fdp_stereo {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::CameraInfoConstPtr;

constexpr std::size_t kMaxWaiting = 1000;   // stamps that wait for their partners
constexpr std::uint32_t kQueueSize = 5;     // of the node
constexpr double kJumpBack = 0.5;           // s, of the node: a recording of several runs
constexpr std::uint32_t kBeyondEnd = 3600;  // s

std::string milliseconds(double seconds) {
  std::ostringstream text;
  text << std::setprecision(3) << seconds * 1e3 << " ms";
  return text.str();
}

}  // namespace

void StampDistance::add(bool first, const ros::Time& stamp) {
  last_[first ? 0 : 1] = stamp;
  const auto& other = last_[first ? 1 : 0];
  if (other) nearest_s_ = std::min(nearest_s_, std::abs(secondsBetween(*other, stamp)));
}

void PairCollector::restart() {
  if (!options_.approximate) return;
  Policy policy(kQueueSize);
  if (options_.tolerance_s > 0.0) policy.setMaxIntervalDuration(ros::Duration(options_.tolerance_s));
  approximate_ = std::make_unique<message_filters::Synchronizer<Policy>>(policy);
  approximate_->registerCallback(&PairCollector::onPair, this);
}

void PairCollector::watchStamp(Input input, const ros::Time& stamp) {
  const bool jumped_back = last_[input] && secondsBetween(stamp, *last_[input]) > kJumpBack;
  last_[input] = stamp;
  newest_ = std::max(newest_, stamp);
  if (input == kLeftImage || input == kRightImage) images_distance_.add(input == kLeftImage, stamp);
  if (input == kLeftImage || input == kLeftInfo) left_info_distance_.add(input == kLeftImage, stamp);
  if (input == kRightImage || input == kRightInfo) right_info_distance_.add(input == kRightImage, stamp);
  if (!jumped_back) return;
  last_ = {};
  last_[input] = stamp;
  restart();
}

template <int kInput, typename MessagePtr>
void PairCollector::addApproximate(const MessagePtr& message, const ros::Time& stamp) {
  using Message = typename MessagePtr::element_type;
  try {
    approximate_->add<kInput>(ros::MessageEvent<Message>(message, stamp));
  } catch (const std::runtime_error&) {  // the policy computes with stamps, which may be anything
    restart();
  }
}

void PairCollector::addImage(Input side, BagImageConstPtr image) {
  ++images_;
  const ros::Time stamp = image->stamp;
  watchStamp(side, stamp);
  if (options_.approximate) {
    return side == kLeftImage ? addApproximate<0>(image, stamp) : addApproximate<2>(image, stamp);
  }
  (side == kLeftImage ? waiting_[stamp].left : waiting_[stamp].right) = std::move(image);
  completeAt(stamp);
}

void PairCollector::addInfo(Input side, const CameraInfoConstPtr& info) {
  const ros::Time stamp = info->header.stamp;
  watchStamp(side, stamp);
  if (options_.approximate) {
    return side == kLeftInfo ? addApproximate<1>(info, stamp) : addApproximate<3>(info, stamp);
  }
  (side == kLeftInfo ? waiting_[stamp].left_info : waiting_[stamp].right_info) = info;
  completeAt(stamp);
}

void PairCollector::completeAt(const ros::Time& stamp) {
  const auto found = waiting_.find(stamp);
  const BagPair& pair = found->second;
  if (pair.left && pair.right && pair.left_info && pair.right_info) {
    onPair(pair.left, pair.left_info, pair.right, pair.right_info);
    waiting_.erase(found);
  } else if (waiting_.size() > kMaxWaiting) {
    waiting_.erase(waiting_.begin());
  }
}

/// The policy gives a pair when the next messages show that none is nearer: these are the next ones.
void PairCollector::finish() {
  if (!options_.approximate || newest_.sec > ros::TIME_MAX.sec - kBeyondEnd) return;
  const ros::Time stamp(newest_.sec + kBeyondEnd, 0);
  const auto no_image = boost::make_shared<const BagImage>(BagImage{stamp, nullptr});
  const auto info = boost::make_shared<CameraInfo>();
  info->header.stamp = stamp;
  const CameraInfoConstPtr no_info = info;
  addApproximate<0>(BagImageConstPtr(no_image), stamp);
  addApproximate<1>(no_info, stamp);
  addApproximate<2>(BagImageConstPtr(no_image), stamp);
  addApproximate<3>(no_info, stamp);
}

void PairCollector::onPair(const BagImageConstPtr& left, const CameraInfoConstPtr& left_info,
                           const BagImageConstPtr& right, const CameraInfoConstPtr& right_info) {
  const bool whole =
      left->message && right->message && left_info->header.stamp <= newest_ && right_info->header.stamp <= newest_;
  if (!whole) return;
  ++pairs_;
  ready_.push_back({left, right, left_info, right_info});
}

std::optional<BagPair> PairCollector::take() {
  if (ready_.empty()) return std::nullopt;
  const BagPair pair = ready_.front();
  ready_.pop_front();
  return pair;
}

std::string PairCollector::silence(const StereoTopics& topics) const {
  const auto apart = [&](const StampDistance& distance, const std::string& a, const std::string& b) {
    const double limit_s = options_.approximate ? options_.tolerance_s : 0.0;
    if (distance.seconds() <= limit_s || (options_.approximate && limit_s == 0.0)) return std::string();
    if (!std::isfinite(distance.seconds())) return a + " and " + b + " never come together";
    return "the stamps of " + a + " and " + b + " are at best " + milliseconds(distance.seconds()) + " apart" +
           (distance.seconds() > 1.0 ? "; they were not recorded together, or their clocks differ"
            : options_.approximate   ? "; allow that with --approximate-sync-tolerance"
                                     : "; use --approximate-sync");
  };
  std::string images = apart(images_distance_, topics.left_image, topics.right_image);
  if (!images.empty()) return images;
  for (const std::string& infos : {apart(left_info_distance_, topics.left_image, topics.left_info),
                                   apart(right_info_distance_, topics.right_image, topics.right_info)}) {
    if (!infos.empty()) return infos + ", or give the files with --left-calibration and --right-calibration";
  }
  return "no moment has all four of " + topics.left_image + ", " + topics.right_image + ", " + topics.left_info +
         " and " + topics.right_info + "; use --approximate-sync";
}

}  // namespace fdp_stereo
