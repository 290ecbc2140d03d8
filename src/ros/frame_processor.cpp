// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_processor.hpp"

#include <cmath>
#include <future>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "fdp_stereo/hidden_pixels.hpp"
#include "fdp_stereo/io.hpp"
#include "search_range.hpp"
#include "stamps.hpp"
#include "text.hpp"

namespace fdp_stereo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kJumpedBack[] = "the stamps jumped back";

std::string describe(const cv::Mat& image) {
  return text(image.cols, " x ", image.rows, " px, ", image.depth() == CV_8U ? 8 : 16, " bit");
}

/// A camera that is not at the origin of its frame.
void describePlace(const PinholeCamera& left, const StereoFrame& frame, const std::string& topic, FrameReport& report) {
  if (left.tx == 0.0 && left.ty == 0.0) return;
  report.notes.push_back(text(topic, ": P[3] = ", left.tx, ", P[7] = ", left.ty, ": the camera is at (",
                              -left.tx / left.fx, ", ", -left.ty / left.fy, ", 0) m beside the origin of ",
                              quoteForLog(frame.left->header.frame_id), "; depth, seeds and points2 follow that, but ",
                              "points of depth_image_proc have the camera as their origin"));
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

bool limitsDepth(const NodeParams& node) { return node.max_depth_error_m > 0.0 || node.min_confidence > 0.0; }

bool needsQuality(const NodeParams& node, const WantedOutputs& wanted) {
  return wanted.confidence || wanted.depth_error || (wanted.depth && limitsDepth(node));
}

/// The disparity without the pixels that are not sure enough, or whose depth is not; filled ones have no estimate.
cv::Mat sureDisparity(const PipelineResult& result, const cv::Mat& depth_error, const NodeParams& node) {
  if (!limitsDepth(node)) return result.disparity;
  cv::Mat sure = result.disparity.clone();
  if (node.min_confidence > 0.0) sure.setTo(kInvalidDisparity, result.confidence < node.min_confidence);
  if (node.max_depth_error_m > 0.0) sure.setTo(kInvalidDisparity, ~(depth_error <= node.max_depth_error_m));
  return sure;
}

void fillMaps(const StereoFrame& frame, const NodeSettings& settings, const StereoGeometry& geometry,
              const WantedOutputs& wanted, const PipelineResult& result, FrameOutput& output) {
  const std_msgs::Header& header = frame.left->header;
  const DisparityRange range = settings.pipeline.search;
  if (wanted.disparity) {
    output.disparity = toDisparityMessage(result.disparity, header, geometry, range, disparityStep(settings.pipeline));
  }
  const bool quality = needsQuality(settings.node, wanted);
  const cv::Mat depth_error = quality ? depthError(result.disparity, result.sigma, geometry) : cv::Mat();
  if (wanted.depth) {
    output.depth = toDepthMessage(sureDisparity(result, depth_error, settings.node), header, geometry,
                                  {settings.node.min_depth_m, settings.node.max_depth_m});
    output.depth_info = depthInfo(frame);
  }
  if (wanted.confidence) output.confidence = toImageMessage(result.confidence, header);
  if (wanted.depth_error) output.depth_error = toImageMessage(depth_error, header);
  if (wanted.seeds) output.seeds = toImageMessage(drawSeeds(result.left, allSeeds(result), range), header);
  if (wanted.disparity_color) output.disparity_color = toImageMessage(colorize(result.disparity, range), header);
}

}  // namespace

FrameOutput FrameProcessor::process(const StereoFrame& frame, const NodeSettings& settings, const WantedOutputs& wanted,
                                    const std::atomic<bool>* cancel) {
  FrameOutput output;
  FrameReport& report = output.report;
  Images images = decodePair(frame, report.warnings);
  const cv::Size size = images[0].size();
  const StereoGeometry geometry = stereoGeometry(*frame.left_info, *frame.right_info, size, topics_, report.warnings);
  if (images_ == InputImages::kRaw) images = rectifyPair(frame, images, report);
  if (wanted.left_rectified) output.left_rectified = toImageMessage(images[0], frame.left->header);
  if (wanted.left_rectified && !wanted.maps()) return output;
  const DisparityRange range = settings.pipeline.search;
  checkRange(range, size.width, geometry, report.warnings);
  report.notes.push_back(
      text(topics_.left_image, " (", describe(images[0]), "): ", visibleDistances(range, size.width, geometry)));
  const PinholeCamera camera = pinholeCamera(*frame.left_info, size);
  describePlace(camera, frame, topics_.left_info, report);

  const auto patience =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(settings.node.seeds_wait_s));
  const Seeds external =
      externalSeeds({frame, settings, camera, geometry, Clock::now() + patience, cancel, report.warnings}, report);
  followTime(frame.left->header.stamp);
  const bool quality = needsQuality(settings.node, wanted);
  PipelineResult result = runPipeline(images, external, settings, quality, cancel);
  if (cancel != nullptr && *cancel) return output;
  fillMaps(frame, settings, geometry, wanted, result, output);
  fillReport(result, report);
  report.scale = settings.pipeline.scale;
  return output;
}

/// Raw images of this pair and what is to be said of them.
FrameProcessor::Images FrameProcessor::rectifyPair(const StereoFrame& frame, const Images& raw, FrameReport& report) {
  const auto start = Clock::now();
  const auto tell = [&](const sensor_msgs::CameraInfo& info, const std::string& image_topic,
                        const std::string& info_topic) {
    const bool needed = needsRectification(info);
    if (!needed)
      report.notes.push_back(text(image_topic, ": ", info_topic, " leaves nothing to rectify: used as it is"));
    if (needed && isRectifiedName(image_topic)) {
      report.warnings.push_back(text(image_topic,
                                     ": rectified already, by its name, and now once more; give raw images,",
                                     " or set ~rectify to none"));
    }
  };
  tell(*frame.left_info, topics_.left_image, topics_.left_info);
  tell(*frame.right_info, topics_.right_image, topics_.right_info);
  // At the same time, as two nodelets of image_proc would.
  std::future<cv::Mat> right = std::async(
      std::launch::async, [&] { return right_rectifier_.rectify(raw[1], *frame.right_info, topics_.right_info); });
  cv::Mat left = left_rectifier_.rectify(raw[0], *frame.left_info, topics_.left_info);
  Images rectified{std::move(left), right.get()};
  report.rectification_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return rectified;
}

/// The masks that are given, and the borders that rectification leaves.
MaskPair FrameProcessor::masksFor(cv::Size size) const {
  MaskPair masks = masks_ ? masks_(size) : MaskPair();
  const std::array<cv::Mat, 2> borders{left_rectifier_.border(), right_rectifier_.border()};
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (!borders[i].empty()) masks[i] = masks[i].empty() ? borders[i] : cv::Mat(masks[i] | borders[i]);
  }
  return masks;
}

PipelineResult FrameProcessor::runPipeline(const Images& images, const Seeds& external, const NodeSettings& settings,
                                           bool quality, const std::atomic<bool>* cancel) {
  Pipeline& pipeline = pipelineFor(settings);
  pipeline.setQuality(quality ? Pipeline::Quality::kEstimated : Pipeline::Quality::kNone);
  const MaskPair masks = masksFor(images[0].size());
  pipeline.setMasks(masks[0], masks[1]);
  PipelineResult result = pipeline.run(images[0], images[1], external, cancel);
  // What both cameras cannot have seen stays unknown though filled: consumers rely on a map that is not fully dense.
  if (settings.pipeline.hole_filling.enabled) dropHidden(result.disparity);
  return result;
}

void FrameProcessor::fillReport(PipelineResult& result, FrameReport& report) {
  report.seeds = result.seeds.size();
  report.rejected_seeds = result.rejected_seeds.size();
  report.quasi_dense_seeds = result.quasi_dense_seeds.size();
  report.valid_share = validShare(result.disparity);
  report.pipeline = std::move(result);
  if (!report.pipeline.feature_note.empty()) report.warnings.push_back(report.pipeline.feature_note);
  const RowAlignment& rows = report.pipeline.row_alignment;
  if (rows.warning.empty()) return;
  // The numbers change a little with every pair; as a new text each they would flood a log.
  constexpr double kMuchTheSame = 0.5;
  if (!(std::abs(rows.offset_rms_px - told_rows_.offset_rms_px) < kMuchTheSame * told_rows_.offset_rms_px)) {
    told_rows_ = rows;
  }
  report.warnings.push_back(told_rows_.warning);
}

Seeds FrameProcessor::externalSeeds(const SeedRequest& request, FrameReport& report) const {
  if (!seeds_) return {};
  Seeds seeds = seeds_(request);
  report.external_seeds = seeds.size();
  return seeds;
}

void FrameProcessor::reset() {
  if (pipeline_) pipeline_->reset(kJumpedBack);
}

/// What was seen long ago, or is yet to come, says nothing of now.
void FrameProcessor::followTime(const ros::Time& stamp) {
  constexpr double kLongestGap = 1.0;  // s
  const double passed = last_stamp_.isZero() || stamp.isZero() ? 0.0 : secondsBetween(last_stamp_, stamp);
  last_stamp_ = stamp;
  if (!pipeline_) return;
  if (passed < 0.0) pipeline_->reset(kJumpedBack);
  if (passed > kLongestGap) pipeline_->resetStream("no pair for more than a second");
}

FrameProcessor::Images FrameProcessor::decodePair(const StereoFrame& frame, std::vector<std::string>& warnings) const {
  checkHeader(frame.left->header, topics_.left_image, warnings);
  cv::Mat left = decodeImage(*frame.left, topics_.left_image);
  cv::Mat right = decodeImage(*frame.right, topics_.right_image);
  if (left.size() != right.size() || left.depth() != right.depth()) {
    fail(topics_.left_image, " has ", describe(left), " but ", topics_.right_image, " has ", describe(right),
         "; both cameras must run in one mode");
  }
  if (left.channels() != right.channels()) {
    warnings.push_back(topics_.left_image + " is " + frame.left->encoding + " and " + topics_.right_image + " is " +
                       frame.right->encoding + ": both are used as grey");
  }
  return {left, right};
}

Pipeline& FrameProcessor::pipelineFor(const NodeSettings& settings) {
  if (!pipeline_) {
    pipeline_ = std::make_unique<Pipeline>(settings.pipeline);
    pipeline_->setStream(true);
  } else if (revision_ != settings.revision) {
    pipeline_->setParams(settings.pipeline);
  } else if (pipeline_->params().scale != settings.pipeline.scale) {
    pipeline_->setScale(settings.pipeline.scale);
  }
  revision_ = settings.revision;
  return *pipeline_;
}

}  // namespace fdp_stereo
