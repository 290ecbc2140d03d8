// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/proposers.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace fdp_stereo::local_expansion {
namespace {

constexpr float kPi = 3.14159265F;
constexpr float kSmallestNormalZ = 0.05F;  // steeper planes are not worth proposing
constexpr double kConfidence = 0.95;
constexpr int kScoredPoints = 256;  // points that a sample is scored on; more change the choice very little

cv::Point randomPixel(const cv::Rect& core, Random& random) {
  return {core.x + random.below(core.width), core.y + random.below(core.height)};
}

Eigen::Vector3f unitVector(Random& random) {
  const float z = random.uniform(-1.0F, 1.0F);
  const float angle = random.uniform(0.0F, 2.0F * kPi);
  const float r = std::sqrt(1.0F - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// Of length 1. Eigen's own sums of three numbers have another order on other processors.
Eigen::Vector3f normalized(const Eigen::Vector3f& v) {
  return v / std::sqrt(v.x() * v.x() + (v.y() * v.y() + v.z() * v.z()));
}

// Slopes of the plane with this normal.
Plane planeWithNormal(float x, float y, float d, const Eigen::Vector3f& normal) {
  const float z = std::max(normal.z(), kSmallestNormalZ);
  return Plane::through(x, y, d, -normal.x() / z, -normal.y() / z);
}

bool planeOfThree(const SurfacePoint& p, const SurfacePoint& q, const SurfacePoint& r, Plane& plane) {
  const float qx = q.x - p.x, qy = q.y - p.y, qd = q.d - p.d;
  const float rx = r.x - p.x, ry = r.y - p.y, rd = r.d - p.d;
  const float det = qx * ry - rx * qy;
  if (std::fabs(det) < 0.5F) return false;  // pixels are at integers: twice the area is 0 or at least 1
  plane = Plane::through(p.x, p.y, p.d, (qd * ry - rd * qy) / det, (rd * qx - qd * rx) / det);
  return true;
}

int countInliers(const std::vector<SurfacePoint>& points, std::size_t count, const Plane& plane, float threshold) {
  int inliers = 0;
  for (std::size_t i = 0; i < count; ++i) {
    inliers += std::fabs(plane.at(points[i].x, points[i].y) - points[i].d) <= threshold ? 1 : 0;
  }
  return inliers;
}

// Least squares over the inliers of `plane`; false where they lie on a line.
bool refine(const std::vector<SurfacePoint>& points, float threshold, Plane& plane) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const SurfacePoint origin = points.front();
  for (const SurfacePoint& p : points) {
    if (std::fabs(plane.at(p.x, p.y) - p.d) > threshold) continue;
    const Eigen::Vector3d v(static_cast<double>(p.x - origin.x), static_cast<double>(p.y - origin.y), 1.0);
    normal += v * v.transpose();
    right += v * static_cast<double>(p.d);
  }
  if (std::fabs(normal.determinant()) < 1e-3) return false;
  const Eigen::Vector3d solution = normal.inverse() * right;
  plane = Plane::through(origin.x, origin.y, static_cast<float>(solution(2)), static_cast<float>(solution(0)),
                         static_cast<float>(solution(1)));
  return true;
}

Plane medianPlane(std::vector<SurfacePoint>& points) {
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [](const SurfacePoint& p, const SurfacePoint& q) { return p.d < q.d; });
  return {0.0F, 0.0F, middle->d};
}

// Moves a random choice of at most kScoredPoints points to the front.
std::size_t chooseScored(std::vector<SurfacePoint>& points, Random& random) {
  const std::size_t count = std::min<std::size_t>(points.size(), kScoredPoints);
  if (count == points.size()) return count;
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(points[i], points[i + random.below(static_cast<int>(points.size() - i))]);
  }
  return count;
}

}  // namespace

Plane proposeExpansion(const Labels& labels, const cv::Rect& core, Random& random) {
  const cv::Point p = randomPixel(core, random);
  return labels.plane(p.x, p.y);
}

Plane proposeRandom(const Labels& labels, const cv::Rect& core, DisparityRange range, float reach, float tilt,
                    Random& random) {
  const cv::Point p = randomPixel(core, random);
  const Plane plane = labels.plane(p.x, p.y);
  const float d = std::clamp(plane.at(p.x, p.y) + random.uniform(-reach, reach), static_cast<float>(range.min),
                             static_cast<float>(range.max()));
  const Eigen::Vector3f normal = normalized({-plane.a, -plane.b, 1.0F}) + tilt * unitVector(random);
  return planeWithNormal(static_cast<float>(p.x), static_cast<float>(p.y), d, normalized(normal));
}

Plane fitPlane(std::vector<SurfacePoint>& points, const RansacParams& params, Random& random) {
  if (points.size() < 3) return points.empty() ? Plane{} : medianPlane(points);
  const std::size_t scored = chooseScored(points, random);
  const float threshold = static_cast<float>(params.threshold_px);
  const int count = static_cast<int>(scored);
  Plane best;
  int most = 0;
  double needed = params.samples;
  for (int sample = 0; sample < params.samples && sample < needed; ++sample) {
    Plane plane;
    const SurfacePoint& p = points[random.below(count)];
    const SurfacePoint& q = points[random.below(count)];
    const SurfacePoint& r = points[random.below(count)];
    if (!planeOfThree(p, q, r, plane)) continue;
    const int inliers = countInliers(points, scored, plane, threshold);
    if (inliers <= most) continue;
    most = inliers;
    best = plane;
    const double share = static_cast<double>(inliers) / count;
    needed = share >= 1.0 ? 0.0 : std::log(1.0 - kConfidence) / std::log(1.0 - share * share * share);
  }
  if (most < 3 || !refine(points, threshold, best)) return medianPlane(points);
  return best;
}

Plane proposeRansac(const Labels& labels, const cv::Rect& core, const RansacParams& params, Random& random,
                    std::vector<SurfacePoint>& points) {
  points.clear();
  for (int y = core.y; y < core.y + core.height; ++y) {
    for (int x = core.x; x < core.x + core.width; ++x) {
      points.push_back({static_cast<float>(x), static_cast<float>(y), labels.disparity(x, y)});
    }
  }
  return fitPlane(points, params, random);
}

Plane randomPlane(float x, float y, float d, float max_angle, Random& random) {
  const float tilt = random.uniform(0.0F, max_angle);
  const float direction = random.uniform(0.0F, 2.0F * kPi);
  const Eigen::Vector3f normal(std::sin(tilt) * std::cos(direction), std::sin(tilt) * std::sin(direction),
                               std::cos(tilt));
  return planeWithNormal(x, y, d, normal);
}

}  // namespace fdp_stereo::local_expansion
