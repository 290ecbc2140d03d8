// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mask_sources.hpp"

#include <stdexcept>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "text.hpp"

namespace fdp_stereo {

MaskSources::MaskSources(const ros::NodeHandle& node, StartParams& params) : node_(node) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const std::string side = i == 0 ? "left" : "right";
    sources_[i].name = "~" + side + "_mask";
    sources_[i].path = params.param<std::string>(side + "_mask", "");
    sources_[i].topic = node_.resolveName(side + "/mask");
  }
}

void MaskSources::subscribe() {
  for (Source& source : sources_) {
    source.subscriber = node_.subscribe<sensor_msgs::Image>(source.topic, 1, [&](const sensor_msgs::ImageConstPtr& m) {
      const std::lock_guard<std::mutex> lock(mutex_);
      source.message = m;
    });
  }
}

void MaskSources::unsubscribe() {
  for (Source& source : sources_) source.subscriber.shutdown();
}

MaskPair MaskSources::masks(cv::Size size) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {maskOf(sources_[0], size), maskOf(sources_[1], size)};
}

cv::Mat MaskSources::maskOf(Source& source, cv::Size size) {
  if (source.message) {
    source.mask = toMask(decodeImage(*source.message, source.topic));
    source.message.reset();
  } else if (source.mask.empty() && !source.path.empty()) {
    try {
      source.mask = toMask(readImage(source.path));
    } catch (const std::runtime_error& error) {
      fail(source.name, ": ", error.what(), "; give a picture of the rectified image's size, or no mask");
    }
  }
  if (!source.mask.empty() && source.mask.size() != size) {
    const cv::Size given = source.mask.size();
    fail(source.name, " or ", source.topic, ": a mask of ", given.width, " x ", given.height, " px, but the image has ",
         size.width, " x ", size.height, "; give one of the rectified image's size");
  }
  return source.mask;
}

}  // namespace fdp_stereo
