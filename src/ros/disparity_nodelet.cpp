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
#include <nodelet/nodelet.h>
#include <ros/master.h>
#include <pluginlib/class_list_macros.hpp>

#include "frame_processor.hpp"
#include "frame_worker.hpp"
#include "node_status.hpp"
#include "pair_synchronizer.hpp"
#include "periodic_task.hpp"
#include "reconfigure_server.hpp"
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
constexpr auto kLogPeriod = std::chrono::seconds(30);
constexpr std::size_t kMaxLogLines = 20;
constexpr char kOutOfMemory[] =
    "out of memory; lower disparity_range or scale, and max_memory_mb to what this machine has";

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

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

/// s; the fallback where what is given is no sensible period.
std::chrono::duration<double> periodOf(double wanted_s, double fallback_s) {
  constexpr double kShortest = 0.02;   // s
  constexpr double kLongest = 3600.0;  // s
  return std::chrono::duration<double>(wanted_s >= kShortest && wanted_s <= kLongest ? wanted_s : fallback_s);
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
  void nameInputs();
  void startReports(std::chrono::duration<double> diagnostic_period, std::chrono::duration<double> watch_period);
  void advertise();
  void onSubscriberChange();
  WantedOutputs wanted() const;
  void subscribe();
  void subscribeImages(const ros::TransportHints& hints);
  void unsubscribe();

  template <typename MessagePtr>
  void onInput(PairSynchronizer::Input input, const MessagePtr& message);
  void onPair(const StereoFrame& frame);
  void onRestart();
  bool overRate(const ros::Time& stamp);

  void work(const StereoFrame& frame, const std::atomic<bool>& cancel);
  bool tooOld(const StereoFrame& frame, const NodeSettings& settings);
  void publish(const FrameOutput& output);
  void recordSuccess(const StereoFrame& frame, FrameOutput& output, Clock::time_point start, unsigned revision);
  void recordFailure(const std::string& problem);

  bool isNew(const std::string& text);
  void warn(const std::string& text);
  NodeStatus snapshot();
  void onDiagnostics(diagnostic_updater::DiagnosticStatusWrapper& diagnostics);
  void watch();

  StereoTopics topics_;
  std::unique_ptr<ReconfigureServer> reconfigure_;
  std::unique_ptr<SeedSources> seeds_;
  std::unique_ptr<FrameProcessor> processor_;
  std::atomic<bool> forget_{false};  ///< tells the worker that the stamps jumped back

  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber left_image_, right_image_;
  ros::Subscriber left_info_, right_info_;
  std::unique_ptr<PairSynchronizer> synchronizer_;
  ros::Time last_taken_;

  // Outputs. The mutex is held over advertise: a subscriber may come before the publisher is stored.
  std::mutex connect_mutex_;
  bool subscribed_ = false;
  ros::Publisher disparity_;
  image_transport::CameraPublisher depth_;
  image_transport::Publisher depth_by_old_name_, confidence_, seeds_image_, disparity_color_;

  std::mutex status_mutex_;
  NodeStatus status_;
  NodeStatus diagnosed_, watched_;  ///< at the last report
  Clock::time_point diagnosed_at_, watched_at_;
  LogThrottle throttle_{kLogPeriod, kMaxLogLines};
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::unique_ptr<PeriodicTask> diagnostics_task_, watch_task_;

  std::unique_ptr<FrameWorker> worker_;
};

DisparityNodelet::~DisparityNodelet() { release(); }

/// The worker first, for a publisher that is shut down must not be used; then from the sources of callbacks to what
/// they use: shutdown() waits for a callback that runs in another thread.
void DisparityNodelet::release() {
  if (worker_) worker_->stop();
  disparity_.shutdown();
  depth_.shutdown();
  depth_by_old_name_.shutdown();
  confidence_.shutdown();
  seeds_image_.shutdown();
  disparity_color_.shutdown();
  diagnostics_task_.reset();
  diagnostics_.reset();
  watch_task_.reset();
  if (worker_) unsubscribe();
  worker_.reset();
  seeds_.reset();
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
  ros::NodeHandle& node = getNodeHandle();
  nameInputs();
  StartParams params(getPrivateNodeHandle());
  const auto say = [this](const std::string& message) { warn(message); };
  const PairSynchronizerParams sync = readSynchronizerParams(params, say);
  status_.approximate_sync = sync.approximate;
  params.param<std::string>("image_transport", "raw");  // which image_transport reads itself
  const auto diagnostic_period = periodOf(params.param("diagnostic_period", kDiagnosticsPeriod), kDiagnosticsPeriod);
  const auto watch_period = periodOf(params.param("watch_period", kWatchPeriod), kWatchPeriod);
  seeds_ = std::make_unique<SeedSources>(node, params);
  reconfigure_ = std::make_unique<ReconfigureServer>(getPrivateNodeHandle(), params.names(), say);

  synchronizer_ = std::make_unique<PairSynchronizer>(
      sync, PairSynchronizer::Callbacks{[this](const StereoFrame& frame) { onPair(frame); }, [this] { onRestart(); },
                                        [this](PairSynchronizer::Input input, const ros::Time& stamp) {
                                          warn(text(status_.inputs[input].topic, ": stamp ", stamp.toSec(),
                                                    " s is too far from the others'; check the clock of the camera"));
                                        }});
  processor_ = std::make_unique<FrameProcessor>(
      topics_, [this](const SeedRequest& request) { return seeds_->collect(request); });
  worker_ = std::make_unique<FrameWorker>(
      [this](const StereoFrame& frame, const std::atomic<bool>& cancel) { work(frame, cancel); });
  startReports(diagnostic_period, watch_period);
  advertise();
}

void DisparityNodelet::nameInputs() {
  const ros::NodeHandle& node = getNodeHandle();
  topics_ = {node.resolveName("left/image_rect"), node.resolveName("right/image_rect"),
             node.resolveName("left/camera_info"), node.resolveName("right/camera_info")};
  status_.inputs[PairSynchronizer::kLeftImage].topic = topics_.left_image;
  status_.inputs[PairSynchronizer::kLeftInfo].topic = topics_.left_info;
  status_.inputs[PairSynchronizer::kRightImage].topic = topics_.right_image;
  status_.inputs[PairSynchronizer::kRightInfo].topic = topics_.right_info;
}

void DisparityNodelet::startReports(std::chrono::duration<double> diagnostic_period,
                                    std::chrono::duration<double> watch_period) {
  diagnosed_at_ = watched_at_ = Clock::now();
  diagnostics_ = std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), getPrivateNodeHandle(), getName());
  diagnostics_->setHardwareID("none");
  diagnostics_->add("Disparity", this, &DisparityNodelet::onDiagnostics);
  diagnostics_task_ = std::make_unique<PeriodicTask>(diagnostic_period, [this] { diagnostics_->force_update(); });
  // The question to a master that is out of reach may take long: not in the queue of the images.
  watch_task_ = std::make_unique<PeriodicTask>(watch_period, [this] { watch(); });
}

void DisparityNodelet::advertise() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  ros::NodeHandle& node = getNodeHandle();
  transport_ = std::make_unique<image_transport::ImageTransport>(node);
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onSubscriberChange(); };
  const image_transport::SubscriberStatusCallback image_changed =
      [this](const image_transport::SingleSubscriberPublisher&) { onSubscriberChange(); };
  disparity_ = node.advertise<stereo_msgs::DisparityImage>("disparity", 1, changed, changed);
  // As image_transport's CameraSubscriber finds it: depth/image_rect with depth/camera_info.
  depth_ = transport_->advertiseCamera("depth/image_rect", 1, image_changed, image_changed, changed, changed);
  depth_by_old_name_ = transport_->advertise("depth", 1, image_changed, image_changed);
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
  outputs.depth = depth_.getNumSubscribers() + depth_by_old_name_.getNumSubscribers() > 0;
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
      "left/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(PairSynchronizer::kLeftInfo, m); },
      ros::VoidConstPtr(), no_delay);
  right_info_ = node.subscribe<CameraInfo>(
      "right/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(PairSynchronizer::kRightInfo, m); },
      ros::VoidConstPtr(), no_delay);
  seeds_->subscribe();
}

/// Throws image_transport::Exception where ~image_transport names no transport that there is.
void DisparityNodelet::subscribeImages(const ros::TransportHints& ros_hints) {
  const image_transport::TransportHints hints("raw", ros_hints, getPrivateNodeHandle());
  left_image_ = transport_->subscribe(
      "left/image_rect", 1, [this](const ImageConstPtr& m) { onInput(PairSynchronizer::kLeftImage, m); },
      ros::VoidPtr(), hints);
  right_image_ = transport_->subscribe(
      "right/image_rect", 1, [this](const ImageConstPtr& m) { onInput(PairSynchronizer::kRightImage, m); },
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

template <typename MessagePtr>
void DisparityNodelet::onInput(PairSynchronizer::Input input, const MessagePtr& message) {
  try {
    synchronizer_->add(input, message);
  } catch (const std::bad_alloc&) {  // of the one message: the manager goes on
    recordFailure(kOutOfMemory);
  }
}

void DisparityNodelet::onRestart() {
  last_taken_ = ros::Time();
  forget_ = true;
}

void DisparityNodelet::onPair(const StereoFrame& frame) {
  const bool over_rate = overRate(frame.left->header.stamp);
  {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    ++status_.pairs;
    if (over_rate) ++status_.over_rate;
  }
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
    recordFailure(kOutOfMemory);
  } catch (const cv::Exception& error) {
    recordFailure(error.code == cv::Error::StsNoMem ? kOutOfMemory : error.what());
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
    depth_.publish(output.depth, output.depth_info);
    depth_by_old_name_.publish(output.depth);
  }
  if (output.confidence) confidence_.publish(output.confidence);
  if (output.seeds) seeds_image_.publish(output.seeds);
  if (output.disparity_color) disparity_color_.publish(output.disparity_color);
}

void DisparityNodelet::recordSuccess(const StereoFrame& frame, FrameOutput& output, Clock::time_point start,
                                     unsigned revision) {
  const auto now = Clock::now();
  for (const std::string& warning : output.report.warnings) warn(warning);
  for (const std::string& note : output.report.notes) {
    if (isNew(note)) NODELET_INFO("%s", note.c_str());
  }
  const std::lock_guard<std::mutex> lock(status_mutex_);
  ++status_.processed;
  status_.error_is_current = false;
  status_.processing_ms = milliseconds(now - start);
  status_.latency_ms = milliseconds(now - frame.arrival);
  status_.age_ms = secondsBetween(frame.left->header.stamp, ros::Time::now()) * 1e3;
  status_.apart_ms = secondsBetween(frame.left->header.stamp, frame.right->header.stamp) * 1e3;
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

bool DisparityNodelet::isNew(const std::string& text) {
  const std::lock_guard<std::mutex> lock(status_mutex_);
  return throttle_.allow(text, Clock::now());
}

void DisparityNodelet::warn(const std::string& text) {
  if (isNew(text)) NODELET_WARN("%s", text.c_str());
}

NodeStatus DisparityNodelet::snapshot() {
  const std::lock_guard<std::mutex> connect_lock(connect_mutex_);
  const std::lock_guard<std::mutex> lock(status_mutex_);
  const PairSynchronizer::Counts counts = synchronizer_->counts();
  for (std::size_t i = 0; i < counts.size(); ++i) status_.inputs[i].count = counts[i];
  if (subscribed_) {
    status_.inputs[PairSynchronizer::kLeftImage].publishers = left_image_.getNumPublishers();
    status_.inputs[PairSynchronizer::kRightImage].publishers = right_image_.getNumPublishers();
    status_.inputs[PairSynchronizer::kLeftInfo].publishers = left_info_.getNumPublishers();
    status_.inputs[PairSynchronizer::kRightInfo].publishers = right_info_.getNumPublishers();
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
