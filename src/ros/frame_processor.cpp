// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_processor.hpp"

#include <sstream>
#include <stdexcept>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

std::string describe(const cv::Mat& image) {
  std::ostringstream text;
  text << image.cols << " x " << image.rows << " px, " << (image.depth() == CV_8U ? 8 : 16) << " bit";
  return text.str();
}

/// For display: the brightest value of 16 bits becomes white.
cv::Mat toEightBit(const cv::Mat& image) {
  if (image.depth() == CV_8U) return image;
  double brightest = 0.0;
  cv::minMaxLoc(image.reshape(1), nullptr, &brightest);
  cv::Mat eight_bit;
  image.convertTo(eight_bit, CV_8U, brightest > 0.0 ? 255.0 / brightest : 1.0);
  return eight_bit;
}

/// A range with which no pixel of the image has a match is a mistake, not an empty scene.
void checkRange(DisparityRange range, int width, std::vector<std::string>& warnings) {
  std::ostringstream text;
  text << "min_disparity = " << range.min << ", disparity_range = " << range.count;
  if (range.min >= width || range.max() <= -width) {
    throw std::invalid_argument(text.str() + ": no pixel of an image " + std::to_string(width) +
                                " px wide can have such a disparity; set min_disparity near 0");
  }
  if (range.count > width) {
    warnings.push_back(text.str() + ": wider than the image, " + std::to_string(width) +
                       " px; a smaller disparity_range gives the same in less time");
  }
}

/// What others do with the result needs both.
void checkHeader(const std_msgs::Header& header, const std::string& topic, std::vector<std::string>& warnings) {
  if (header.stamp.isZero()) {
    warnings.push_back(topic + ": stamp is 0; the driver must stamp its images: seeds, max_rate and max_age need it");
  }
  if (header.frame_id.empty()) {
    warnings.push_back(topic + ": frame_id '' is empty; set it in the driver: tf and points need it");
  }
}

/// Filled or not, what the right camera cannot see stays unknown: consumers rely on a map that is not fully dense.
void dropUnseen(cv::Mat& disparity) {
  for (int y = 0; y < disparity.rows; ++y) {
    auto* row = disparity.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      const float match = static_cast<float>(x) - row[x];
      if (match < 0.0F || match > static_cast<float>(disparity.cols - 1)) row[x] = kInvalidDisparity;
    }
  }
}

double validShare(const cv::Mat& disparity) {
  return static_cast<double>(cv::countNonZero(disparity == disparity)) / static_cast<double>(disparity.total());
}

/// 1 px where the optimiser gives whole disparities; fits and planes are continuous, told as OpenCV's 1/16 px.
double disparityStep(const PipelineParams& params) {
  constexpr double kContinuous = 1.0 / 16.0;
  const bool whole =
      (params.optimizer == OptimizerType::kWinnerTakesAll && params.winner_takes_all.subpixel == SubpixelFit::kNone) ||
      (params.optimizer == OptimizerType::kSemiGlobal && params.semi_global.subpixel == SubpixelFit::kNone);
  return whole ? 1.0 : kContinuous;
}

sensor_msgs::CameraInfoPtr depthInfo(const StereoFrame& frame) {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(*frame.left_info);
  info->header = frame.left->header;
  return info;
}

}  // namespace

FrameOutput FrameProcessor::process(const StereoFrame& frame, const NodeSettings& settings, const WantedOutputs& wanted,
                                    const std::atomic<bool>* cancel) {
  FrameOutput output;
  const StereoPair pair = decodePair(frame, output.report.warnings);
  const StereoGeometry geometry =
      stereoGeometry(*frame.left_info, *frame.right_info, pair.left.size(), topics_, output.report.warnings);
  const DisparityRange range = settings.pipeline.search;
  checkRange(range, pair.left.cols, output.report.warnings);

  const Seeds external = externalSeeds(frame, settings, pair.left.size(), geometry, output.report);
  PipelineResult result = pipelineFor(settings).run(pair.left, pair.right, external, cancel);
  if (cancel != nullptr && *cancel) return output;
  dropUnseen(result.disparity);

  const std_msgs::Header& header = frame.left->header;
  if (wanted.disparity) {
    output.disparity = toDisparityMessage(result.disparity, header, geometry, range, disparityStep(settings.pipeline));
  }
  if (wanted.depth) {
    output.depth =
        toDepthMessage(result.disparity, header, geometry, {settings.node.min_depth_m, settings.node.max_depth_m});
    output.depth_info = depthInfo(frame);
  }
  if (wanted.confidence) output.confidence = toImageMessage(result.confidence, header);
  if (wanted.seeds) {
    const cv::Mat drawn = drawSeeds(toEightBit(pair.left), allSeeds(result), range);
    output.seeds = toImageMessage(drawn, header);
  }
  if (wanted.disparity_color) output.disparity_color = toImageMessage(colorize(result.disparity, range), header);
  output.report.times = std::move(result.times);
  output.report.propagated_share = result.propagated_share;
  output.report.seeds = result.seeds.size();
  output.report.rejected_seeds = result.rejected_seeds.size();
  output.report.quasi_dense_seeds = result.quasi_dense_seeds.size();
  output.report.row_offset_px = result.row_alignment.offset_rms_px;
  output.report.valid_share = validShare(result.disparity);
  return output;
}

Seeds FrameProcessor::externalSeeds(const StereoFrame& frame, const NodeSettings& settings, cv::Size size,
                                    const StereoGeometry& geometry, FrameReport& report) const {
  if (!seeds_) return {};
  Seeds seeds = seeds_(frame, settings, pinholeCamera(*frame.left_info, size), geometry, report.warnings);
  if (!seeds.empty() && !settings.pipeline.disparity_propagation.enabled) {
    report.warnings.push_back("seeds arrive but disparity_propagation_enabled is false: they have little effect");
  }
  report.external_seeds = seeds.size();
  return seeds;
}

void FrameProcessor::reset() {
  if (pipeline_) pipeline_->reset();
}

StereoPair FrameProcessor::decodePair(const StereoFrame& frame, std::vector<std::string>& warnings) const {
  checkHeader(frame.left->header, topics_.left_image, warnings);
  StereoPair pair;
  pair.left = decodeImage(*frame.left, topics_.left_image);
  pair.right = decodeImage(*frame.right, topics_.right_image);
  if (pair.left.size() != pair.right.size() || pair.left.depth() != pair.right.depth()) {
    throw std::invalid_argument(topics_.left_image + " has " + describe(pair.left) + " but " + topics_.right_image +
                                " has " + describe(pair.right) + "; both cameras must run in one mode");
  }
  if (pair.left.channels() != pair.right.channels()) {
    warnings.push_back(topics_.left_image + " is " + frame.left->encoding + " and " + topics_.right_image + " is " +
                       frame.right->encoding + ": both are used as grey");
  }
  return pair;
}

Pipeline& FrameProcessor::pipelineFor(const NodeSettings& settings) {
  if (!pipeline_) {
    pipeline_ = std::make_unique<Pipeline>(settings.pipeline);
  } else if (revision_ != settings.revision) {
    pipeline_->setParams(settings.pipeline);
  }
  revision_ = settings.revision;
  return *pipeline_;
}

}  // namespace fdp_stereo
