// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <stereo_msgs/DisparityImage.h>

#include "conversions.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "frame_worker.hpp"
#include "mask_sources.hpp"
#include "params_ros.hpp"
#include "rectifier.hpp"
#include "seed_conversions.hpp"

namespace fdp_stereo {

/// Outputs that somebody listens to.
struct WantedOutputs {
  bool disparity = false;
  bool depth = false;
  bool confidence = false;
  bool seeds = false;
  bool disparity_color = false;
  bool depth_error = false;
  bool left_rectified = false;

  /// What needs the pipeline.
  bool maps() const { return disparity || depth || confidence || seeds || disparity_color || depth_error; }
  bool any() const { return maps() || left_rectified; }
};

/// What is told about one pair.
struct FrameReport {
  std::vector<std::string> warnings;  ///< what is odd, and what to do
  std::vector<std::string> notes;     ///< what is good to know of camera and range
  PipelineStats pipeline;
  std::size_t external_seeds = 0;  ///< of other sensors, as given to the pipeline
  std::size_t seeds = 0;
  std::size_t rejected_seeds = 0;
  std::size_t quasi_dense_seeds = 0;
  double valid_share = 0.0;       ///< of the pixels
  double rectification_ms = 0.0;  ///< of both images
  double scale = 1.0;             ///< of the images that were matched
};

/// Messages of one pair, null where not wanted.
struct FrameOutput {
  stereo_msgs::DisparityImagePtr disparity;
  sensor_msgs::ImagePtr depth;
  sensor_msgs::CameraInfoPtr depth_info;
  sensor_msgs::ImagePtr confidence;
  sensor_msgs::ImagePtr depth_error;      ///< m, 1 sigma, NaN where there is no estimate
  sensor_msgs::ImagePtr seeds;            ///< the left image with the seeds, bgr8
  sensor_msgs::ImagePtr disparity_color;  ///< colours over the searched range, black = none, bgr8
  sensor_msgs::ImagePtr left_rectified;   ///< the left image as it is matched
  FrameReport report;
};

/// What a pair asks of other sensors.
struct SeedRequest {
  const StereoFrame& frame;
  const NodeSettings& settings;
  const PinholeCamera& left;
  const StereoGeometry& geometry;
  std::chrono::steady_clock::time_point
      deadline;                        ///< until when it may be waited for messages, of all sources together
  const std::atomic<bool>* cancel;     ///< ends the waiting; may be null
  std::vector<std::string>& warnings;  ///< what was left out and why
};
using SeedProvider = std::function<Seeds(const SeedRequest& request)>;
/// What to leave out of the images of a size.
using MaskProvider = std::function<MaskPair(cv::Size size)>;

/// How images arrive.
enum class InputImages { kRectified, kRaw };

/// From messages to messages: checks, the pipeline, conversions. Not thread-safe; needs no node.
class FrameProcessor {
 public:
  /// Raw images are rectified first, and the border that this leaves black is masked.
  explicit FrameProcessor(StereoTopics topics, SeedProvider seeds = nullptr, MaskProvider masks = nullptr,
                          InputImages images = InputImages::kRectified)
      : topics_(std::move(topics)), seeds_(std::move(seeds)), masks_(std::move(masks)), images_(images) {}

  /// Throws std::invalid_argument naming the topic, the value and the remedy where no disparity can come out. The
  /// outputs stay null where `cancel` was set meanwhile.
  FrameOutput process(const StereoFrame& frame, const NodeSettings& settings, const WantedOutputs& wanted,
                      const std::atomic<bool>* cancel = nullptr);
  /// Forgets what was learnt from earlier frames: the stamps jumped back.
  void reset();

 private:
  /// The left and the right image.
  using Images = std::array<cv::Mat, 2>;
  Images decodePair(const StereoFrame& frame, std::vector<std::string>& warnings) const;
  Images rectifyPair(const StereoFrame& frame, const Images& raw, FrameReport& report);
  MaskPair masksFor(cv::Size size) const;
  Pipeline& pipelineFor(const NodeSettings& settings);
  void followTime(const ros::Time& stamp);

  Seeds externalSeeds(const SeedRequest& request, FrameReport& report) const;
  PipelineResult runPipeline(const Images& images, const Seeds& external, const NodeSettings& settings, bool quality,
                             const std::atomic<bool>* cancel);
  void fillReport(PipelineResult& result, FrameReport& report);

  StereoTopics topics_;
  SeedProvider seeds_;
  MaskProvider masks_;
  InputImages images_;
  Rectifier left_rectifier_, right_rectifier_;
  std::unique_ptr<Pipeline> pipeline_;
  unsigned revision_ = 0;
  ros::Time last_stamp_;
  RowAlignment told_rows_;  ///< whose warning is told as long as the offset is much the same
};

}  // namespace fdp_stereo
