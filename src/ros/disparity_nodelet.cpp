// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Topics only: what is computed is in frame_processor, what is told in node_status.
#include <chrono>
#include <memory>
#include <mutex>
#include <new>

#include <diagnostic_updater/diagnostic_updater.h>
#include <image_transport/exception.h>
#include <image_transport/image_transport.h>
#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <nodelet/nodelet.h>
#include <ros/master.h>
#include <pluginlib/class_list_macros.hpp>

#include "frame_processor.hpp"
#include "frame_worker.hpp"
#include "node_status.hpp"
#include "periodic_task.hpp"
#include "reconfigure_server.hpp"
#include "seed_sources.hpp"
#include "stamps.hpp"
#include "thread_priority.hpp"

namespace fdp_stereo {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::CameraInfoConstPtr;
using sensor_msgs::Image;
using sensor_msgs::ImageConstPtr;
using Clock = std::chrono::steady_clock;
using ExactPolicy = message_filters::sync_policies::ExactTime<Image, CameraInfo, Image, CameraInfo>;
using ApproximatePolicy = message_filters::sync_policies::ApproximateTime<Image, CameraInfo, Image, CameraInfo>;

/// A stamp that is older than its predecessor by more than this is a bag that starts again, not a late message.
constexpr double kJumpBack = 0.5;           // s
constexpr double kLongestTolerance = 60.0;  // s
constexpr double kDiagnosticsPeriod = 1.0;  // s
constexpr double kWatchPeriod = 15.0;       // s
constexpr auto kLogPeriod = std::chrono::seconds(10);
constexpr std::size_t kMaxLogLines = 20;

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

enum Input { kLeftImage, kLeftInfo, kRightImage, kRightInfo };

}  // namespace

/// stereo_image_proc's disparity, by this package's pipeline.
class DisparityNodelet : public nodelet::Nodelet {
 public:
  ~DisparityNodelet() override;

 private:
  void onInit() override;
  std::chrono::duration<double> period(const std::string& name, double fallback_s) const;
  void advertise();
  void onSubscriberChange();
  WantedOutputs wanted() const;
  void subscribe();
  void subscribeImages(const ros::TransportHints& hints);
  void unsubscribe();

  template <typename Message>
  void onInput(Input input, const boost::shared_ptr<const Message>& message, message_filters::PassThrough<Message>& to);
  void resetSynchronizer();
  void onPair(const ImageConstPtr& left, const CameraInfoConstPtr& left_info, const ImageConstPtr& right,
              const CameraInfoConstPtr& right_info);
  bool overRate(const ros::Time& stamp);

  void work(const StereoFrame& frame, const std::atomic<bool>& cancel);
  bool tooOld(const StereoFrame& frame, const NodeSettings& settings);
  void publish(const FrameOutput& output);
  void recordSuccess(const StereoFrame& frame, FrameOutput& output, Clock::time_point start, unsigned revision);
  void recordFailure(const std::string& problem);

  void warn(const std::string& text);
  NodeStatus snapshot();
  void onDiagnostics(diagnostic_updater::DiagnosticStatusWrapper& diagnostics);
  void watch();

  StereoTopics topics_;
  std::unique_ptr<ReconfigureServer> reconfigure_;
  std::unique_ptr<SeedSources> seeds_;
  std::unique_ptr<FrameProcessor> processor_;
  std::atomic<bool> forget_{false};  ///< tells the worker that the stamps jumped back

  // Inputs: callbacks, then one pass-through per topic, so that the synchroniser can be replaced.
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber left_image_, right_image_;
  ros::Subscriber left_info_, right_info_;
  message_filters::PassThrough<Image> left_image_filter_, right_image_filter_;
  message_filters::PassThrough<CameraInfo> left_info_filter_, right_info_filter_;
  std::unique_ptr<message_filters::Synchronizer<ExactPolicy>> exact_;
  std::unique_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate_;
  int queue_size_ = 5;
  bool approximate_sync_ = false;
  double tolerance_s_ = 0.0;
  ros::Time last_taken_;

  // Outputs. The mutex is held over advertise: a subscriber may come before the publisher is stored.
  std::mutex connect_mutex_;
  bool subscribed_ = false;
  ros::Publisher disparity_, depth_info_;
  image_transport::Publisher depth_, confidence_, seeds_image_, disparity_color_;

  std::mutex status_mutex_;
  NodeStatus status_;
  NodeStatus diagnosed_, watched_;  ///< at the last report
  Clock::time_point diagnosed_at_, watched_at_;
  LogThrottle throttle_{kLogPeriod, kMaxLogLines};
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::unique_ptr<PeriodicTask> diagnostics_task_, watch_task_;

  std::unique_ptr<FrameWorker> worker_;
};

/// The worker first, for a publisher that is shut down must not be used; then from the sources of callbacks to what
/// they use: shutdown() waits for a callback that runs in another thread.
DisparityNodelet::~DisparityNodelet() {
  if (worker_) worker_->stop();
  disparity_.shutdown();
  depth_.shutdown();
  depth_info_.shutdown();
  confidence_.shutdown();
  seeds_image_.shutdown();
  disparity_color_.shutdown();
  diagnostics_task_.reset();
  watch_task_.reset();
  if (worker_) unsubscribe();
  worker_.reset();
  reconfigure_.reset();
}

void DisparityNodelet::onInit() {
  ros::NodeHandle& node = getNodeHandle();
  ros::NodeHandle& private_node = getPrivateNodeHandle();
  topics_ = {node.resolveName("left/image_rect"), node.resolveName("right/image_rect"),
             node.resolveName("left/camera_info"), node.resolveName("right/camera_info")};
  status_.inputs[kLeftImage].topic = topics_.left_image;
  status_.inputs[kLeftInfo].topic = topics_.left_info;
  status_.inputs[kRightImage].topic = topics_.right_image;
  status_.inputs[kRightInfo].topic = topics_.right_info;
  private_node.param("queue_size", queue_size_, queue_size_);
  private_node.param("approximate_sync", approximate_sync_, approximate_sync_);
  private_node.param("approximate_sync_tolerance", tolerance_s_, tolerance_s_);
  if (queue_size_ < 1) {
    warn("~queue_size = " + std::to_string(queue_size_) + " must be at least 1; using 1");
    queue_size_ = 1;
  }
  if (!(tolerance_s_ >= 0.0 && tolerance_s_ <= kLongestTolerance)) {
    warn("~approximate_sync_tolerance = " + std::to_string(tolerance_s_) + " s must be 0 to " +
         std::to_string(kLongestTolerance) + " s; using 0, which is none");
    tolerance_s_ = 0.0;
  }
  status_.approximate_sync = approximate_sync_;
  resetSynchronizer();

  reconfigure_ = std::make_unique<ReconfigureServer>(
      private_node,
      std::vector<std::string>{"preset", "queue_size", "approximate_sync", "approximate_sync_tolerance",
                               "image_transport", "watch_period", "diagnostic_period", "seeds_fixed_frame"},
      [this](const std::string& message) { warn(message); });
  seeds_ = std::make_unique<SeedSources>(node, private_node);
  processor_ = std::make_unique<FrameProcessor>(
      topics_, [this](const StereoFrame& frame, const NodeSettings& settings, const PinholeCamera& left,
                      const StereoGeometry& geometry, std::vector<std::string>& warnings) {
        return seeds_->collect(frame, settings, left, geometry, warnings);
      });
  worker_ = std::make_unique<FrameWorker>(
      [this](const StereoFrame& frame, const std::atomic<bool>& cancel) { work(frame, cancel); });

  diagnosed_at_ = watched_at_ = Clock::now();
  diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, private_node, getName());
  diagnostics_->setHardwareID("none");
  diagnostics_->add("Disparity", this, &DisparityNodelet::onDiagnostics);
  diagnostics_task_ = std::make_unique<PeriodicTask>(period("diagnostic_period", kDiagnosticsPeriod),
                                                     [this] { diagnostics_->force_update(); });
  // The question to a master that is out of reach may take long: not in the queue of the images.
  watch_task_ = std::make_unique<PeriodicTask>(period("watch_period", kWatchPeriod), [this] { watch(); });
  advertise();
}

std::chrono::duration<double> DisparityNodelet::period(const std::string& name, double fallback_s) const {
  constexpr double kShortest = 0.02;  // s
  const double wanted = getPrivateNodeHandle().param(name, fallback_s);
  return std::chrono::duration<double>(wanted >= kShortest && wanted <= 3600.0 ? wanted : fallback_s);
}

void DisparityNodelet::advertise() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  ros::NodeHandle& node = getNodeHandle();
  transport_ = std::make_unique<image_transport::ImageTransport>(node);
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onSubscriberChange(); };
  const image_transport::SubscriberStatusCallback image_changed =
      [this](const image_transport::SingleSubscriberPublisher&) { onSubscriberChange(); };
  disparity_ = node.advertise<stereo_msgs::DisparityImage>("disparity", 1, changed, changed);
  depth_ = transport_->advertise("depth", 1, image_changed, image_changed);
  depth_info_ = node.advertise<CameraInfo>("depth/camera_info", 1, changed, changed);
  confidence_ = transport_->advertise("confidence", 1, image_changed, image_changed);
  seeds_image_ = transport_->advertise("seeds/image", 1, image_changed, image_changed);
  disparity_color_ = transport_->advertise("disparity_color", 1, image_changed, image_changed);
}

void DisparityNodelet::onSubscriberChange() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  if (wanted().any() == subscribed_) return;
  subscribed_ = !subscribed_;
  if (subscribed_) {
    subscribe();
  } else {
    unsubscribe();
  }
  const std::lock_guard<std::mutex> status_lock(status_mutex_);
  status_.subscribed = subscribed_;
}

WantedOutputs DisparityNodelet::wanted() const {
  WantedOutputs outputs;
  outputs.disparity = disparity_.getNumSubscribers() > 0;
  outputs.depth = depth_.getNumSubscribers() + depth_info_.getNumSubscribers() > 0;
  outputs.confidence = confidence_.getNumSubscribers() > 0;
  outputs.seeds = seeds_image_.getNumSubscribers() > 0;
  outputs.disparity_color = disparity_color_.getNumSubscribers() > 0;
  return outputs;
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
      "left/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(kLeftInfo, m, left_info_filter_); },
      ros::VoidConstPtr(), no_delay);
  right_info_ = node.subscribe<CameraInfo>(
      "right/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(kRightInfo, m, right_info_filter_); },
      ros::VoidConstPtr(), no_delay);
  seeds_->subscribe();
}

/// Throws image_transport::Exception where ~image_transport names no transport that there is.
void DisparityNodelet::subscribeImages(const ros::TransportHints& ros_hints) {
  const image_transport::TransportHints hints("raw", ros_hints, getPrivateNodeHandle());
  left_image_ = transport_->subscribe(
      "left/image_rect", 1, [this](const ImageConstPtr& m) { onInput(kLeftImage, m, left_image_filter_); },
      ros::VoidPtr(), hints);
  right_image_ = transport_->subscribe(
      "right/image_rect", 1, [this](const ImageConstPtr& m) { onInput(kRightImage, m, right_image_filter_); },
      ros::VoidPtr(), hints);
}

void DisparityNodelet::unsubscribe() {
  left_image_.shutdown();
  right_image_.shutdown();
  left_info_.shutdown();
  right_info_.shutdown();
  seeds_->unsubscribe();
  worker_->clear();
}

template <typename Message>
void DisparityNodelet::onInput(Input input, const boost::shared_ptr<const Message>& message,
                               message_filters::PassThrough<Message>& to) {
  const ros::Time stamp = message->header.stamp;
  bool jumped_back = false;
  {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    InputStatus& status = status_.inputs[input];
    jumped_back = status.received > 0 && secondsBetween(stamp, status.stamp) > kJumpBack;
    ++status.received;
    status.stamp = stamp;
    if (jumped_back) {
      for (InputStatus& other : status_.inputs) other.stamp = std::min(other.stamp, stamp);
    }
  }
  if (jumped_back) {
    resetSynchronizer();
    last_taken_ = ros::Time();
    forget_ = true;
  }
  try {
    to.add(message);
  } catch (const std::runtime_error&) {  // ApproximateTime computes with stamps, which may be anything
    warn(status_.inputs[input].topic + ": stamp " + std::to_string(stamp.toSec()) +
         " s is too far from the others'; check the clock of the camera");
    resetSynchronizer();
  }
}

void DisparityNodelet::resetSynchronizer() {
  exact_.reset();
  approximate_.reset();
  const auto queue_size = static_cast<std::uint32_t>(queue_size_);
  if (approximate_sync_) {
    ApproximatePolicy policy(queue_size);
    if (tolerance_s_ > 0.0) policy.setMaxIntervalDuration(ros::Duration(tolerance_s_));
    approximate_ = std::make_unique<message_filters::Synchronizer<ApproximatePolicy>>(policy);
    approximate_->connectInput(left_image_filter_, left_info_filter_, right_image_filter_, right_info_filter_);
    approximate_->registerCallback(&DisparityNodelet::onPair, this);
  } else {
    exact_ = std::make_unique<message_filters::Synchronizer<ExactPolicy>>(ExactPolicy(queue_size));
    exact_->connectInput(left_image_filter_, left_info_filter_, right_image_filter_, right_info_filter_);
    exact_->registerCallback(&DisparityNodelet::onPair, this);
  }
}

void DisparityNodelet::onPair(const ImageConstPtr& left, const CameraInfoConstPtr& left_info,
                              const ImageConstPtr& right, const CameraInfoConstPtr& right_info) {
  const bool over_rate = overRate(left->header.stamp);
  {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    ++status_.pairs;
    if (over_rate) ++status_.over_rate;
  }
  if (!over_rate) worker_->submit({left, right, left_info, right_info, Clock::now()});
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
  const std::shared_ptr<const NodeSettings> settings = reconfigure_->settings();
  try {
    if (tooOld(frame, *settings)) return;
    if (!setNiceLevel(settings->node.nice, settings->pipeline.threads)) {
      warn("nice cannot be lowered without privileges; restart the node");
    }
    if (forget_.exchange(false)) processor_->reset();
    FrameOutput output = processor_->process(frame, *settings, wanted(), &cancel);
    if (cancel) return;
    publish(output);
    recordSuccess(frame, output, start, settings->revision);
  } catch (const std::bad_alloc&) {
    recordFailure("out of memory; lower disparity_range or scale, and max_memory_mb to what this machine has");
  } catch (const std::exception& error) {
    recordFailure(error.what());
  }
}

bool DisparityNodelet::tooOld(const StereoFrame& frame, const NodeSettings& settings) {
  const double max_age = settings.node.max_age_s;
  if (max_age <= 0.0 || secondsBetween(frame.left->header.stamp, ros::Time::now()) <= max_age) return false;
  const std::lock_guard<std::mutex> lock(status_mutex_);
  ++status_.too_old;
  return true;
}

void DisparityNodelet::publish(const FrameOutput& output) {
  if (output.disparity) disparity_.publish(output.disparity);
  if (output.depth) {
    depth_.publish(output.depth);
    depth_info_.publish(output.depth_info);
  }
  if (output.confidence) confidence_.publish(output.confidence);
  if (output.seeds) seeds_image_.publish(output.seeds);
  if (output.disparity_color) disparity_color_.publish(output.disparity_color);
}

void DisparityNodelet::recordSuccess(const StereoFrame& frame, FrameOutput& output, Clock::time_point start,
                                     unsigned revision) {
  const auto now = Clock::now();
  for (const std::string& warning : output.report.warnings) warn(warning);
  const std::lock_guard<std::mutex> lock(status_mutex_);
  ++status_.processed;
  status_.error_is_current = false;
  status_.processing_ms = milliseconds(now - start);
  status_.latency_ms = milliseconds(now - frame.arrival);
  status_.age_ms = secondsBetween(frame.left->header.stamp, ros::Time::now()) * 1e3;
  status_.revision = revision;
  status_.frame = std::move(output.report);
}

void DisparityNodelet::recordFailure(const std::string& problem) {
  warn(problem);
  const std::lock_guard<std::mutex> lock(status_mutex_);
  ++status_.failed;
  status_.last_error = problem;
  status_.error_is_current = true;
}

void DisparityNodelet::warn(const std::string& text) {
  {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    if (!throttle_.allow(text, Clock::now())) return;
  }
  NODELET_WARN("%s", text.c_str());
}

NodeStatus DisparityNodelet::snapshot() {
  const std::lock_guard<std::mutex> connect_lock(connect_mutex_);
  const std::lock_guard<std::mutex> lock(status_mutex_);
  if (subscribed_) {
    status_.inputs[kLeftImage].publishers = left_image_.getNumPublishers();
    status_.inputs[kRightImage].publishers = right_image_.getNumPublishers();
    status_.inputs[kLeftInfo].publishers = left_info_.getNumPublishers();
    status_.inputs[kRightInfo].publishers = right_info_.getNumPublishers();
  }
  status_.dropped = worker_->dropped();
  status_.waiting = worker_->waiting();
  return status_;
}

void DisparityNodelet::onDiagnostics(diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  const NodeStatus status = snapshot();
  const auto now = Clock::now();
  describeStatus(status, diagnosed_, milliseconds(now - diagnosed_at_) / 1e3, diagnostics);
  diagnosed_ = status;
  diagnosed_at_ = now;
}

void DisparityNodelet::watch() {
  const bool lost = !ros::master::check();
  bool changed = false;
  {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    changed = lost != status_.master_lost;
    status_.master_lost = lost;
  }
  if (changed && lost) NODELET_ERROR("the ROS master does not answer; connected topics go on");
  if (changed && !lost) {
    NODELET_WARN("the ROS master is back; if it was restarted it does not know this node: restart it (respawn)");
  }
  const NodeStatus status = snapshot();
  const auto now = Clock::now();
  const std::string silence = describeSilence(status, watched_, milliseconds(now - watched_at_) / 1e3);
  if (!silence.empty()) NODELET_WARN("%s", silence.c_str());
  watched_ = status;
  watched_at_ = now;
}

}  // namespace fdp_stereo

PLUGINLIB_EXPORT_CLASS(fdp_stereo::DisparityNodelet, nodelet::Nodelet)
