// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Disparity to points, free space and scan. What is computed is in point_messages.
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <thread>

#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <fdp_stereo/PointsConfig.h>
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <tf2_ros/transform_listener.h>
#include <pluginlib/class_list_macros.hpp>

#include "isometry.hpp"
#include "newest_worker.hpp"
#include "node_status.hpp"
#include "periodic_task.hpp"
#include "point_frame.hpp"
#include "point_messages.hpp"
#include "point_params.hpp"
#include "text.hpp"

namespace fdp_stereo {

class PointsNodelet : public nodelet::Nodelet {
 public:
  ~PointsNodelet() override { release(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Status {
    unsigned long long published = 0;
    unsigned long long failed = 0;
    std::string problem;           ///< of the last frame, "" = none
    std::vector<std::string> odd;  ///< of the last frame
  };

  void onInit() override;
  void start();
  void release();
  void reconfigure();
  PointsNodeParams params() const;
  void advertise();
  void onSubscriberChange();
  void subscribe();
  void unsubscribe();
  bool wanted() const;

  template <typename Part>
  void onInput(Part PointFrame::*part, std::size_t topic, const Part& message, const ros::Time& stamp);
  PointFrameCollector::Needs needs() const;

  void work(const PointFrame& frame, const std::atomic<bool>& cancel);
  void publish(const PointFrame& frame, const std::atomic<bool>& cancel, std::vector<std::string>& warnings);
  void publishScan(const PointView& view, const cv::Mat& free_depth, const PointsNodeParams& params,
                   const std::atomic<bool>& cancel);
  Eigen::Isometry3d scanFromCamera(const std_msgs::Header& header, const std::atomic<bool>& cancel) const;

  void warn(const std::string& text);
  void record(const std::string& problem, std::vector<std::string> odd);
  void describe(diagnostic_updater::DiagnosticStatusWrapper& diagnostics);

  mutable std::mutex params_mutex_;
  PointsNodeParams params_;
  boost::recursive_mutex reconfigure_mutex_;  ///< of the server
  std::unique_ptr<dynamic_reconfigure::Server<PointsConfig>> reconfigure_;
  PointTopics topics_;
  std::mutex connect_mutex_;  ///< held over advertise: a subscriber may come before the publisher is stored
  bool subscribed_ = false;
  ros::Publisher points_, free_space_, scan_;
  ros::Subscriber disparity_, info_, confidence_, depth_error_;
  image_transport::Subscriber image_;
  tf2_ros::Buffer transforms_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;

  std::mutex collector_mutex_;
  std::unique_ptr<PointFrameCollector> collector_;
  std::unique_ptr<NewestWorker<PointFrame>> worker_;

  std::mutex status_mutex_;
  Status status_;
  LogThrottle throttle_{std::chrono::seconds(30), 20};
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  std::unique_ptr<PeriodicTask> diagnostics_task_;
};

/// The worker first, for a publisher that is shut down must not be used; then from the sources of callbacks to what
/// they use.
void PointsNodelet::release() {
  if (worker_) worker_->stop();
  for (ros::Publisher* publisher : {&points_, &free_space_, &scan_}) publisher->shutdown();
  diagnostics_task_.reset();
  updater_.reset();
  unsubscribe();
  reconfigure_.reset();
  worker_.reset();
}

/// The loader of a nodelet that throws takes the callback queue away before the nodelet: nothing may be left in it.
void PointsNodelet::onInit() {
  try {
    start();
  } catch (const std::exception& error) {
    NODELET_FATAL("cannot start: %s", error.what());
    release();
    throw;
  }
}

void PointsNodelet::start() {
  ros::NodeHandle& node = getNodeHandle();
  topics_ = {node.resolveName("disparity"), node.resolveName("left/camera_info"), node.resolveName("left/image_rect"),
             node.resolveName("confidence"), node.resolveName("depth_error")};
  params_ = readPointsNodeParams(getPrivateNodeHandle(), [this](const std::string& problem) { warn(problem); });
  reconfigure();
  collector_ = std::make_unique<PointFrameCollector>(static_cast<std::size_t>(params_.queue_size));
  worker_ = std::make_unique<NewestWorker<PointFrame>>(
      [this](const PointFrame& frame, const std::atomic<bool>& cancel) { work(frame, cancel); });
  updater_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
  updater_->setHardwareID("none");
  updater_->add("Points", this, &PointsNodelet::describe);
  diagnostics_task_ = std::make_unique<PeriodicTask>(std::chrono::duration<double>(params_.diagnostic_period_s),
                                                     [this] { updater_->force_update(); });
  advertise();
}

/// From now on by dynamic_reconfigure, beginning with what was read.
void PointsNodelet::reconfigure() {
  const PointsConfig initial = liveConfig(params_);
  reconfigure_ =
      std::make_unique<dynamic_reconfigure::Server<PointsConfig>>(reconfigure_mutex_, getPrivateNodeHandle());
  reconfigure_->updateConfig(initial);
  reconfigure_->setCallback([this](PointsConfig& config, std::uint32_t) {
    const std::lock_guard<std::mutex> lock(params_mutex_);
    applyLive(config, params_, [this](const std::string& problem) { warn(problem); });
  });
}

/// One frame is made with one set.
PointsNodeParams PointsNodelet::params() const {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  return params_;
}

void PointsNodelet::advertise() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  ros::NodeHandle& node = getNodeHandle();
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onSubscriberChange(); };
  points_ = node.advertise<sensor_msgs::PointCloud2>("points2", 1, changed, changed);
  free_space_ = node.advertise<sensor_msgs::PointCloud2>("free_space", 1, changed, changed);
  scan_ = node.advertise<sensor_msgs::LaserScan>("scan", 1, changed, changed);
}

bool PointsNodelet::wanted() const {
  return points_.getNumSubscribers() + free_space_.getNumSubscribers() + scan_.getNumSubscribers() > 0;
}

void PointsNodelet::onSubscriberChange() {
  const std::lock_guard<std::mutex> lock(connect_mutex_);
  if (wanted() == subscribed_) return;
  subscribed_ = !subscribed_;
  if (subscribed_) {
    subscribe();
  } else {
    unsubscribe();
  }
}

void PointsNodelet::subscribe() {
  using sensor_msgs::CameraInfoConstPtr;
  using sensor_msgs::ImageConstPtr;
  ros::NodeHandle& node = getNodeHandle();
  const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
  listener_ = std::make_unique<tf2_ros::TransformListener>(transforms_, node, true);
  disparity_ = node.subscribe<stereo_msgs::DisparityImage>(
      "disparity", 1,
      [this](const stereo_msgs::DisparityImageConstPtr& m) { onInput(&PointFrame::disparity, 0, m, m->header.stamp); },
      ros::VoidConstPtr(), no_delay);
  info_ = node.subscribe<sensor_msgs::CameraInfo>(
      "left/camera_info", 1, [this](const CameraInfoConstPtr& m) { onInput(&PointFrame::info, 1, m, m->header.stamp); },
      ros::VoidConstPtr(), no_delay);
  image_ = image_transport::ImageTransport(node).subscribe(
      "left/image_rect", 1, [this](const ImageConstPtr& m) { onInput(&PointFrame::image, 2, m, m->header.stamp); },
      ros::VoidPtr(), image_transport::TransportHints("raw", no_delay, getPrivateNodeHandle()));
  confidence_ = node.subscribe<sensor_msgs::Image>(
      "confidence", 1, [this](const ImageConstPtr& m) { onInput(&PointFrame::confidence, 3, m, m->header.stamp); },
      ros::VoidConstPtr(), no_delay);
  depth_error_ = node.subscribe<sensor_msgs::Image>(
      "depth_error", 1, [this](const ImageConstPtr& m) { onInput(&PointFrame::depth_error, 4, m, m->header.stamp); },
      ros::VoidConstPtr(), no_delay);
}

void PointsNodelet::unsubscribe() {
  for (ros::Subscriber* input : {&disparity_, &info_, &confidence_, &depth_error_}) input->shutdown();
  image_.shutdown();
  listener_.reset();
  if (worker_) worker_->clear();
  const std::lock_guard<std::mutex> lock(collector_mutex_);
  if (collector_) collector_->clear();
}

PointFrameCollector::Needs PointsNodelet::needs() const {
  return {points_.getNumSubscribers() > 0, confidence_.getNumPublishers() > 0, depth_error_.getNumPublishers() > 0};
}

template <typename Part>
void PointsNodelet::onInput(Part PointFrame::*part, std::size_t topic, const Part& message, const ros::Time& stamp) {
  try {
    const std::lock_guard<std::mutex> lock(collector_mutex_);
    std::optional<PointFrame> frame = collector_->add(part, topic, message, stamp, needs());
    if (frame) worker_->submit(std::move(*frame));
  } catch (const std::bad_alloc&) {  // of the one message: the manager goes on
    record("out of memory", {});
  }
}

void PointsNodelet::work(const PointFrame& frame, const std::atomic<bool>& cancel) {
  std::vector<std::string> warnings;
  std::string problem;
  try {
    publish(frame, cancel, warnings);
  } catch (const std::exception& error) {
    problem = error.what();
  }
  record(problem, std::move(warnings));
}

void PointsNodelet::publish(const PointFrame& frame, const std::atomic<bool>& cancel,
                            std::vector<std::string>& warnings) {
  const PointsNodeParams params = this->params();
  const PointView view = decodePointFrame(frame, params.points, topics_, warnings);
  if (points_.getNumSubscribers() > 0) points_.publish(toPointCloud(view, params.points.decimation));
  const bool free_wanted = free_space_.getNumSubscribers() > 0;
  const bool scan_wanted = scan_.getNumSubscribers() > 0;
  if (!free_wanted && !scan_wanted) return;
  const cv::Mat free_depth = freeDepth(view);
  if (free_wanted) free_space_.publish(toFreeSpaceCloud(view, free_depth));
  if (scan_wanted) publishScan(view, free_depth, params, cancel);
}

void PointsNodelet::publishScan(const PointView& view, const cv::Mat& free_depth, const PointsNodeParams& params,
                                const std::atomic<bool>& cancel) {
  try {
    const Eigen::Isometry3d place = scanFromCamera(view.header, cancel);
    scan_.publish(toLaserScan(view, free_depth, place, params.scan_frame, params.scan));
  } catch (const tf2::TransformException& error) {
    fail("scan: no transform from ", quoteForLog(view.header.frame_id), " to ~scan_frame ",
         quoteForLog(params_.scan_frame), ": ", error.what());
  }
}

/// Waits a little for a transform that is on its way. By the clock on the wall: the simulated one may stand still.
Eigen::Isometry3d PointsNodelet::scanFromCamera(const std_msgs::Header& header, const std::atomic<bool>& cancel) const {
  const auto end = Clock::now() + std::chrono::milliseconds(100);
  while (true) {
    try {
      return toIsometry(transforms_.lookupTransform(params_.scan_frame, header.frame_id, header.stamp).transform);
    } catch (const tf2::TransformException&) {
      if (cancel || Clock::now() > end) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void PointsNodelet::warn(const std::string& text) {
  const std::lock_guard<std::mutex> lock(status_mutex_);
  if (throttle_.allow(text, Clock::now())) ROS_WARN_NAMED(getName(), "%s", text.c_str());
}

void PointsNodelet::record(const std::string& problem, std::vector<std::string> odd) {
  for (const std::string& text : odd) warn(text);
  if (!problem.empty()) warn(problem);
  const std::lock_guard<std::mutex> lock(status_mutex_);
  ++(problem.empty() ? status_.published : status_.failed);
  status_.problem = problem;
  status_.odd = std::move(odd);
}

void PointsNodelet::describe(diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  using diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(status_mutex_);
  diagnostics.summary(DiagnosticStatus::OK, status_.published > 0 ? "running" : "nothing published yet");
  for (const std::string& text : status_.odd) diagnostics.mergeSummary(DiagnosticStatus::WARN, text);
  if (!status_.problem.empty()) diagnostics.summary(DiagnosticStatus::ERROR, status_.problem);
  diagnostics.add("Frames published", status_.published);
  diagnostics.add("Frames failed", status_.failed);
  diagnostics.add("Frames dropped (overload)", worker_->dropped());
}

}  // namespace fdp_stereo

PLUGINLIB_EXPORT_CLASS(fdp_stereo::PointsNodelet, nodelet::Nodelet)
