// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/range_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "fdp_stereo/free_space.hpp"

namespace fdp_stereo {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;

/// A ray in the frame of the scan: the point at depth z is origin + z * direction.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  Eigen::Vector3d at(double z) const { return origin + z * direction; }
};

/// Depths between which a ray is where obstacles count.
struct Stretch {
  double begin;
  double end;
  bool reaches_range;  ///< it ends at the largest range, not at one of the heights
};

double rangeOf(const Eigen::Vector3d& point) { return std::hypot(point.x(), point.y()); }

/// The depth at which a ray gets as far away as `range`; 0 where it begins farther away.
double depthAtRange(const Ray& ray, double range) {
  const double a = ray.direction.head<2>().squaredNorm();
  const double b = ray.origin.head<2>().dot(ray.direction.head<2>());
  const double c = ray.origin.head<2>().squaredNorm() - range * range;
  if (c >= 0.0) return 0.0;
  return a > 0.0 ? (-b + std::sqrt(b * b - a * c)) / a : kInfinity;
}

std::optional<Stretch> stretchOf(const Ray& ray, const RangeScanParams& params) {
  double low = (params.min_height_m - ray.origin.z()) / ray.direction.z();
  double high = (params.max_height_m - ray.origin.z()) / ray.direction.z();
  if (ray.direction.z() == 0.0) {
    const bool inside = ray.origin.z() >= params.min_height_m && ray.origin.z() <= params.max_height_m;
    low = inside ? 0.0 : kInfinity;
    high = kInfinity;
  }
  if (low > high) std::swap(low, high);
  const double farthest = depthAtRange(ray, params.max_range_m);
  const Stretch stretch{std::max(low, 0.0), std::min(high, farthest), farthest <= high};
  if (!(stretch.begin < stretch.end)) return std::nullopt;
  return stretch;
}

/// The scan while it is made. Bearings are counted from that of the camera's axis, so that none of its own jumps.
class Scanner {
 public:
  Scanner(const SeenDepth& seen, const Eigen::Isometry3d& scan_from_camera, const RangeScanParams& params)
      : seen_(seen), scan_from_camera_(scan_from_camera), params_(params) {
    const Eigen::Vector3d axis = scan_from_camera.linear().col(2);
    axis_bearing_ = std::atan2(axis.y(), axis.x());
    double first = kInfinity;
    double last = -kInfinity;
    const auto see = [&](double u, double v) {
      const double bearing = bearingOf(ray(u, v).direction);
      first = std::min(first, bearing);
      last = std::max(last, bearing);
    };
    for (int u = 0; u < seen.depth.cols; ++u) see(u, 0), see(u, seen.depth.rows - 1);
    for (int v = 0; v < seen.depth.rows; ++v) see(0, v), see(seen.depth.cols - 1, v);
    first_ = first;
    const bool sees = last >= first;  // not where the focal length makes all rays infinite
    const std::size_t count = sees ? static_cast<std::size_t>((last - first) / params.increment_rad) + 1 : 0;
    obstacles_.assign(count, kInfinity);
    states_.assign(count, State::kUnseen);
  }

  void addObstacles() {
    for (int v = 0; v < seen_.depth.rows; ++v) {
      const auto* depth = seen_.depth.ptr<float>(v);
      for (int u = 0; u < seen_.depth.cols; ++u) {
        if (!std::isnan(depth[u])) addObstacle(ray(u, v).at(depth[u]));
      }
    }
  }

  void addFreeRays() {
    for (int y = 0; y < seen_.free_depth.rows; ++y) {
      for (int x = 0; x < seen_.free_depth.cols; ++x) {
        const cv::Point pixel = rayPixel({x, y}, seen_.spacing, seen_.depth.size());
        const float answered = seen_.depth.at<float>(pixel);
        addRay(pixel, std::isnan(answered) ? seen_.free_depth.at<float>(y, x) : answered);
      }
    }
  }

  RangeScan result() const {
    RangeScan scan{axis_bearing_ + first_, params_.increment_rad, {}};
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const bool free = states_[i] == State::kFree;
      const double range = obstacles_[i] < kInfinity ? obstacles_[i]
                           : free                    ? params_.max_range_m
                                                     : std::numeric_limits<double>::quiet_NaN();
      scan.ranges.push_back(static_cast<float>(range));
    }
    return scan;
  }

 private:
  enum class State : std::uint8_t { kUnseen, kFree, kUnknown };  ///< the later outweighs

  Ray ray(double u, double v) const {
    const Eigen::Vector3d origin = seen_.camera.backProject(u, v, 0.0);
    return {scan_from_camera_ * origin, scan_from_camera_.linear() * (seen_.camera.backProject(u, v, 1.0) - origin)};
  }
  double bearingOf(const Eigen::Vector3d& direction) const {
    return std::remainder(std::atan2(direction.y(), direction.x()) - axis_bearing_, 2.0 * kPi);
  }
  /// May be beside the scan.
  double binOf(const Eigen::Vector3d& point) const {
    return std::floor((bearingOf(point) - first_) / params_.increment_rad);
  }

  void addObstacle(const Eigen::Vector3d& point) {
    const double range = rangeOf(point);
    // What is no number is within no limits.
    if (!(point.z() >= params_.min_height_m && point.z() <= params_.max_height_m)) return;
    if (!(range >= params_.min_range_m && range <= params_.max_range_m)) return;
    const double bin = binOf(point);
    if (!(bin >= 0.0 && bin < static_cast<double>(obstacles_.size()))) return;
    double& nearest = obstacles_[static_cast<std::size_t>(bin)];
    nearest = std::min(nearest, range);
  }

  /// What the ray of a square tells of the bearings that the square covers. free_to: depth, NaN = not known.
  void addRay(cv::Point pixel, double free_to) {
    const Ray middle = ray(pixel.x, pixel.y);
    const std::optional<Stretch> stretch = stretchOf(middle, params_);
    const double nearest = std::max(seen_.nearest, depthAtRange(middle, params_.min_range_m));
    if (!stretch || stretch->end <= nearest) return;
    const bool free = free_to >= stretch->end;
    if (free && !stretch->reaches_range) return;
    const double from = free ? stretch->end : std::fmax(std::max(stretch->begin, nearest), free_to);
    const double half = seen_.spacing / 2.0;
    double first = kInfinity;
    double last = -kInfinity;
    for (const double u : {pixel.x - half, pixel.x + half}) {
      const Ray edge = ray(u, pixel.y);
      for (const double z : {from, stretch->end}) {
        first = std::min(first, binOf(edge.at(z)));
        last = std::max(last, binOf(edge.at(z)));
      }
    }
    mark(first, last, free ? State::kFree : State::kUnknown);
  }

  /// What is not known of a bearing outweighs what is.
  void mark(double first, double last, State what) {
    const double end = std::min(last, static_cast<double>(states_.size()) - 1.0);
    for (double bin = std::max(first, 0.0); bin <= end; bin += 1.0) {
      State& state = states_[static_cast<std::size_t>(bin)];
      state = std::max(state, what);
    }
  }

  const SeenDepth& seen_;
  const Eigen::Isometry3d& scan_from_camera_;
  const RangeScanParams& params_;
  double axis_bearing_ = 0.0;
  double first_ = 0.0;  ///< bearing from the axis
  std::vector<double> obstacles_;
  std::vector<State> states_;
};

}  // namespace

RangeScan scanRanges(const SeenDepth& seen, const Eigen::Isometry3d& scan_from_camera, const RangeScanParams& params) {
  Scanner scanner(seen, scan_from_camera, params);
  scanner.addObstacles();
  scanner.addFreeRays();
  return scanner.result();
}

}  // namespace fdp_stereo
