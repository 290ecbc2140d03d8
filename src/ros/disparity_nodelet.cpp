// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Brings the parts together: what is computed is in frame_processor, what is told in node_reporter.
#include <array>
#include <chrono>
#include <memory>
#include <mutex>
#include <new>

#include <dynamic_reconfigure/config_tools.h>
#include <image_transport/exception.h>
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "deadline_controller.hpp"
#include "fdp_stereo/buffer.hpp"
#include "fdp_stereo/out_of_memory.hpp"
#include "frame_processor.hpp"
#include "frame_worker.hpp"
#include "node_reporter.hpp"
#include "output_topics.hpp"
#include "pair_synchronizer.hpp"
#include "reconfigure_server.hpp"
#include "search_range.hpp"
#include "seed_sources.hpp"
#include "stamps.hpp"
#include "start_params.hpp"
#include "text.hpp"
#include "thread_priority.hpp"

namespace fdp_stereo {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::CameraInfoConstPtr;
using sensor_msgs::ImageConstPtr;
using Clock = std::chrono::steady_clock;

constexpr double kLongestTolerance = 60.0;  // s
constexpr double kDiagnosticsPeriod = 1.0;  // s
constexpr double kWatchPeriod = 15.0;       // s

PairSynchronizerParams readSynchronizerParams(StartParams& start, const std::function<void(std::string)>& warn) {
  PairSynchronizerParams params;
  params.queue_size = start.param("queue_size", params.queue_size);
  params.approximate = start.param("approximate_sync", params.approximate);
  params.tolerance_s = start.param("approximate_sync_tolerance", params.tolerance_s);
  if (params.queue_size < 1) {
    warn(text("~queue_size = ", params.queue_size, " must be at least 1; using 1"));
    params.queue_size = 1;
  }
  if (!(params.tolerance_s >= 0.0 && params.tolerance_s <= kLongestTolerance)) {
    warn(text("~approximate_sync_tolerance = ", params.tolerance_s, " s must be 0 to ", kLongestTolerance,
              " s; using 0, which is none"));
    params.tolerance_s = 0.0;
  }
  return params;
}

/// The fallback where what is given is no sensible period.
NodeReporter::Seconds readPeriod(StartParams& start, const std::string& name, double fallback_s) {
  constexpr double kShortest = 0.02;   // s
  constexpr double kLongest = 3600.0;  // s
  const double wanted_s = start.param(name, fallback_s);
  return NodeReporter::Seconds(wanted_s >= kShortest && wanted_s <= kLongest ? wanted_s : fallback_s);
}

InputImages readInputImages(StartParams& start, const std::function<void(std::string)>& warn) {
  const auto rectify = start.param<std::string>("rectify", "none");
  if (rectify != "none" && rectify != "internal") {
    warn(text("~rectify = ", quoteForLog(rectify), " must be internal, which takes raw images, or none; using none"));
  }
  return rectify == "internal" ? InputImages::kRaw : InputImages::kRectified;
}

}  // namespace

/// stereo_image_proc's disparity, by this package's pipeline.
class DisparityNodelet : public nodelet::Nodelet {
 public:
  ~DisparityNodelet() override;

 private:
  void onInit() override;
  void start();
  void release();
  std::string imageName(const std::string& side) const {
    return side + (images_ == InputImages::kRaw ? "/image_raw" : "/image_rect");
  }
  void advertise();
  void onSubscriberChange();
  void subscribe();
  void subscribeImages(const ros::TransportHints& hints);
  void unsubscribe();

  template <typename MessagePtr>
  void onInput(PairSynchronizer::Input input, const MessagePtr& message);
  void onPair(const StereoFrame& frame);
  void onRestart();
  bool overRate(const ros::Time& stamp);

  void searchFromNearest(const StereoFrame& frame);
  void work(const StereoFrame& frame, const std::atomic<bool>& cancel);
  bool tooOld(const StereoFrame& frame, const NodeSettings& settings);
  NodeSettings withinDeadline(const NodeSettings& settings);
  void recordTime(const NodeSettings& settings, Clock::time_point start, FrameReport& report);
  void warn(const std::string& text) { reporter_.warn(text); }
  void complete(NodeStatus& status);
  StereoTopics topics() const { return {input_names_[0], input_names_[2], input_names_[1], input_names_[3]}; }

  InputImages images_ = InputImages::kRectified;
  std::array<std::string, 4> input_names_;  ///< resolved, in the order of PairSynchronizer::Input
  std::unique_ptr<ReconfigureServer> reconfigure_;
  std::unique_ptr<SeedSources> seeds_;
  std::unique_ptr<MaskSources> masks_;
  std::unique_ptr<FrameProcessor> processor_;
  double nearest_m_ = 0.0;       ///< that the range shall be made for with the next pair; 0 = as it is
  DeadlineController deadline_;  ///< of the worker's thread, with the revision of the parameters it knows
  unsigned deadline_revision_ = 0;
  std::atomic<bool> forget_{false};  ///< tells the worker that the stamps jumped back

  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber left_image_, right_image_;
  ros::Subscriber left_info_, right_info_;
  std::unique_ptr<PairSynchronizer> synchronizer_;
  ros::Time last_taken_;

  // Outputs. The mutex is held over advertise: a subscriber may come before the publisher is stored.
  std::mutex connect_mutex_;
  bool subscribed_ = false;
  OutputTopics outputs_;

  NodeReporter reporter_;
  std::unique_ptr<FrameWorker> worker_;
};

DisparityNodelet::~DisparityNodelet() { release(); }

/// The worker first, for a publisher that is shut down must not be used; then from the sources of callbacks to what
/// they use: shutdown() waits for a callback that runs in another thread.
void DisparityNodelet::release() {
  if (worker_) worker_->stop();
  outputs_.shutdown();
  reporter_.stop();
  if (worker_) unsubscribe();
  worker_.reset();
  seeds_.reset();
  masks_.reset();
  reconfigure_.reset();
}

/// The loader of a nodelet that throws takes the callback queue away before the nodelet: nothing may be left in it.
void DisparityNodelet::onInit() {
  try {
    start();
  } catch (const std::exception& error) {
    NODELET_FATAL("cannot start: %s", error.what());
    release();
    throw;
  }
}

void DisparityNodelet::start() {
  keepFreedMemory();
  ros::NodeHandle& node = getNodeHandle();
  reporter_.setName(getName());
  const auto say = [this](const std::string& message) { warn(message); };
  StartParams params(getPrivateNodeHandle(), say);
  images_ = readInputImages(params, say);
  input_names_ = {node.resolveName(imageName("left")), node.resolveName("left/camera_info"),
                  node.resolveName(imageName("right")), node.resolveName("right/camera_info")};
  const PairSynchronizerParams sync = readSynchronizerParams(params, say);
  params.param<std::string>("image_transport", "raw");  // which image_transport reads itself
  const NodeReporter::Periods periods{readPeriod(params, "diagnostic_period", kDiagnosticsPeriod),
                                      readPeriod(params, "watch_period", kWatchPeriod)};
  seeds_ = std::make_unique<SeedSources>(node, params);
  masks_ = std::make_unique<MaskSources>(node, params);
  nearest_m_ = params.param("nearest", 0.0);
  reconfigure_ = std::make_unique<ReconfigureServer>(getPrivateNodeHandle(), params.names(), say);

  synchronizer_ = std::make_unique<PairSynchronizer>(
      sync, PairSynchronizer::Callbacks{[this](const StereoFrame& frame) { onPair(frame); }, [this] { onRestart(); },
                                        [this](PairSynchronizer::Input input, const ros::Time& stamp) {
                                          warn(text(input_names_[input], ": stamp ", stamp.toSec(),
                                                    " s is too far from the others'; check the clock of the camera"));
                                        }});
  processor_ = std::make_unique<FrameProcessor>(
      topics(), [this](const SeedRequest& request) { return seeds_->collect(request); },
      [this](cv::Size size) { return masks_->masks(size); }, images_);
  worker_ = std::make_unique<FrameWorker>(
      [this](const StereoFrame& frame, const std::atomic<bool>& cancel) { work(frame, cancel); });
  reporter_.update([&](NodeStatus& status) { status.approximate_sync = sync.approximate; });
  reporter_.start(node, getPrivateNodeHandle(), periods, [this](NodeStatus& status) { complete(status); });
  advertise();
  const std::shared_ptr<const NodeSettings> settings = reconfigure_->settings();
  NODELET_INFO("preset %s, %d disparities; takes %s and %s while %s or another output has a subscriber",
               settings->preset.c_str(), settings->pipeline.search.count, input_names_[0].c_str(),
               input_names_[2].c_str(), node.resolveName("disparity").c_str());
}

void DisparityNodelet::advertise() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  ros::NodeHandle& node = getNodeHandle();
  transport_ = std::make_unique<image_transport::ImageTransport>(node);
  outputs_.advertise(node, images_, [this] { onSubscriberChange(); });
}

void DisparityNodelet::onSubscriberChange() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  if (outputs_.wanted().any() == subscribed_) return;
  subscribed_ = !subscribed_;
  if (subscribed_) {
    subscribe();
  } else {
    unsubscribe();
  }
}

void DisparityNodelet::subscribe() {
  ros::NodeHandle& node = getNodeHandle();
  const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
  try {
    subscribeImages(no_delay);
  } catch (const image_transport::Exception& error) {
    warn("~image_transport: " + std::string(error.what()) + "; using raw");
    getPrivateNodeHandle().setParam("image_transport", "raw");
    subscribeImages(no_delay);
  }
  left_info_ = node.subscribe<CameraInfo>(
      "left/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(PairSynchronizer::kLeftInfo, m); },
      ros::VoidConstPtr(), no_delay);
  right_info_ = node.subscribe<CameraInfo>(
      "right/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(PairSynchronizer::kRightInfo, m); },
      ros::VoidConstPtr(), no_delay);
  seeds_->subscribe();
  masks_->subscribe();
}

/// Throws image_transport::Exception where ~image_transport names no transport that there is.
void DisparityNodelet::subscribeImages(const ros::TransportHints& ros_hints) {
  const image_transport::TransportHints hints("raw", ros_hints, getPrivateNodeHandle());
  left_image_ = transport_->subscribe(
      imageName("left"), 1, [this](const ImageConstPtr& m) { onInput(PairSynchronizer::kLeftImage, m); },
      ros::VoidPtr(), hints);
  right_image_ = transport_->subscribe(
      imageName("right"), 1, [this](const ImageConstPtr& m) { onInput(PairSynchronizer::kRightImage, m); },
      ros::VoidPtr(), hints);
}

void DisparityNodelet::unsubscribe() {
  left_image_.shutdown();
  right_image_.shutdown();
  left_info_.shutdown();
  right_info_.shutdown();
  seeds_->unsubscribe();
  masks_->unsubscribe();
  worker_->clear();
}

template <typename MessagePtr>
void DisparityNodelet::onInput(PairSynchronizer::Input input, const MessagePtr& message) {
  try {
    synchronizer_->add(input, message);
  } catch (const std::bad_alloc&) {  // of the one message: the manager goes on
    reporter_.recordFailure(kOutOfMemory);
  }
}

void DisparityNodelet::onRestart() {
  last_taken_ = ros::Time();
  forget_ = true;
}

void DisparityNodelet::onPair(const StereoFrame& frame) {
  const bool over_rate = overRate(frame.left->header.stamp);
  reporter_.update([&](NodeStatus& status) {
    ++status.pairs;
    if (over_rate) ++status.over_rate;
  });
  if (!over_rate) worker_->submit(frame);
}

bool DisparityNodelet::overRate(const ros::Time& stamp) {
  constexpr double kJitter = 0.05;  // of a period
  const double max_rate = reconfigure_->settings()->node.max_rate_hz;
  const double passed = secondsBetween(last_taken_, stamp);  // 0 where the driver does not stamp its images
  if (max_rate > 0.0 && passed > 0.0 && passed * max_rate < 1.0 - kJitter) return true;
  last_taken_ = stamp;
  return false;
}

void DisparityNodelet::work(const StereoFrame& frame, const std::atomic<bool>& cancel) {
  const auto start = Clock::now();
  try {
    if (nearest_m_ != 0.0) searchFromNearest(frame);
    const std::shared_ptr<const NodeSettings> settings = reconfigure_->settings();
    if (tooOld(frame, *settings)) return;
    if (!setNiceLevel(settings->node.nice, settings->pipeline.threads)) {
      warn("nice cannot be lowered without privileges; restart the node");
    }
    if (forget_.exchange(false)) processor_->reset();
    FrameOutput output = processor_->process(frame, withinDeadline(*settings), outputs_.wanted(), &cancel);
    if (cancel) return;
    outputs_.publish(output);
    recordTime(*settings, start, output.report);
    reporter_.recordSuccess(frame, std::move(output.report), start, settings->revision);
  } catch (...) {
    reporter_.recordFailure(describeCurrentException());
  }
}

/// Needs a calibration that can be used, and then is done: what is edited later holds.
void DisparityNodelet::searchFromNearest(const StereoFrame& frame) {
  const cv::Size size(static_cast<int>(frame.left->width), static_cast<int>(frame.left->height));
  std::vector<std::string> told_with_the_frame;
  const StereoGeometry geometry =
      stereoGeometry(*frame.left_info, *frame.right_info, size, topics(), told_with_the_frame);
  const double nearest_m = std::exchange(nearest_m_, 0.0);
  dynamic_reconfigure::Config edit;
  dynamic_reconfigure::ConfigTools::appendParameter(
      edit, "disparity_range", disparityRangeFor(nearest_m, reconfigure_->settings()->pipeline.search.min, geometry));
  reconfigure_->apply(edit);
}

bool DisparityNodelet::tooOld(const StereoFrame& frame, const NodeSettings& settings) {
  const double max_age = settings.node.max_age_s;
  if (max_age <= 0.0 || secondsBetween(frame.left->header.stamp, ros::Time::now()) <= max_age) return false;
  reporter_.update([](NodeStatus& status) { ++status.too_old; });
  return true;
}

/// With the scale that the deadline leaves.
NodeSettings DisparityNodelet::withinDeadline(const NodeSettings& settings) {
  NodeSettings within = settings;
  if (settings.node.deadline_ms <= 0.0) {
    deadline_ = {};
  } else if (settings.revision != deadline_revision_) {
    deadline_.forget();
  }
  deadline_revision_ = settings.revision;
  within.pipeline.scale = deadline_.scale(settings.pipeline.scale);
  return within;
}

/// Says in the report what was given up for the deadline.
void DisparityNodelet::recordTime(const NodeSettings& settings, Clock::time_point start, FrameReport& report) {
  const double deadline_ms = settings.node.deadline_ms;
  if (deadline_ms <= 0.0 || report.pipeline.times.empty()) return;
  const double wanted = settings.pipeline.scale;
  const double used = deadline_.scale(wanted);
  if (report.pipeline.temporal.repeated) {
    deadline_.recordRepeated();
  } else {
    deadline_.record(std::chrono::duration<double, std::milli>(Clock::now() - start).count(), deadline_ms, wanted);
  }
  if (used >= wanted) return;
  report.warnings.push_back(text("deadline_ms = ", deadline_ms, ": images are matched at ", used,
                                 " of their size, not ", wanted,
                                 deadline_.beyondReach() ? "; pairs are late all the same" : ""));
}

/// What the status needs from the parts.
void DisparityNodelet::complete(NodeStatus& status) {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  status.subscribed = subscribed_;
  const std::array<std::uint32_t, 4> publishers{left_image_.getNumPublishers(), left_info_.getNumPublishers(),
                                                right_image_.getNumPublishers(), right_info_.getNumPublishers()};
  const PairSynchronizer::Counts counts = synchronizer_->counts();
  for (std::size_t i = 0; i < counts.size(); ++i) status.inputs[i] = {input_names_[i], publishers[i], counts[i]};
  status.dropped = worker_->dropped();
  status.waiting = worker_->waiting();
}

}  // namespace fdp_stereo

PLUGINLIB_EXPORT_CLASS(fdp_stereo::DisparityNodelet, nodelet::Nodelet)
