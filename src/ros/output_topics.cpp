// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "output_topics.hpp"

namespace fdp_stereo {

void OutputTopics::advertise(ros::NodeHandle& node, InputImages images, const std::function<void()>& changed) {
  image_transport::ImageTransport transport(node);
  const ros::SubscriberStatusCallback on_change = [=](const ros::SingleSubscriberPublisher&) { changed(); };
  const image_transport::SubscriberStatusCallback on_image_change =
      [=](const image_transport::SingleSubscriberPublisher&) { changed(); };
  const auto advertiseImage = [&](const char* topic) {
    return transport.advertise(topic, 1, on_image_change, on_image_change);
  };
  disparity_ = node.advertise<stereo_msgs::DisparityImage>("disparity", 1, on_change, on_change);
  // As image_transport's CameraSubscriber finds it: depth/image_rect with depth/camera_info.
  depth_ = transport.advertiseCamera("depth/image_rect", 1, on_image_change, on_image_change, on_change, on_change);
  depth_by_old_name_ = advertiseImage("depth");
  confidence_ = advertiseImage("confidence");
  depth_error_ = advertiseImage("depth_error");
  seeds_ = advertiseImage("seeds/image");
  disparity_color_ = advertiseImage("disparity_color");
  if (images == InputImages::kRaw) left_rectified_ = advertiseImage("left/image_rect");
}

void OutputTopics::shutdown() {
  disparity_.shutdown();
  depth_.shutdown();
  for (auto* images :
       {&depth_by_old_name_, &confidence_, &depth_error_, &seeds_, &disparity_color_, &left_rectified_}) {
    images->shutdown();
  }
}

WantedOutputs OutputTopics::wanted() const {
  WantedOutputs outputs;
  outputs.disparity = disparity_.getNumSubscribers() > 0;
  outputs.depth = depth_.getNumSubscribers() + depth_by_old_name_.getNumSubscribers() > 0;
  outputs.confidence = confidence_.getNumSubscribers() > 0;
  outputs.depth_error = depth_error_.getNumSubscribers() > 0;
  outputs.seeds = seeds_.getNumSubscribers() > 0;
  outputs.disparity_color = disparity_color_.getNumSubscribers() > 0;
  outputs.left_rectified = left_rectified_.getNumSubscribers() > 0;
  return outputs;
}

void OutputTopics::publish(const FrameOutput& output) const {
  if (output.disparity) disparity_.publish(output.disparity);
  if (output.depth) {
    depth_.publish(output.depth, output.depth_info);
    depth_by_old_name_.publish(output.depth);
  }
  if (output.confidence) confidence_.publish(output.confidence);
  if (output.depth_error) depth_error_.publish(output.depth_error);
  if (output.seeds) seeds_.publish(output.seeds);
  if (output.disparity_color) disparity_color_.publish(output.disparity_color);
  if (output.left_rectified) left_rectified_.publish(output.left_rectified);
}

}  // namespace fdp_stereo
