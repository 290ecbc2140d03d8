// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/seed_planes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace fdp_stereo::local_expansion {
namespace {

constexpr float kSmallestArea = 1.0F;  // px^2, twice the area: thinner triangles tell no slope

using Position = std::pair<float, float>;

// Twice the signed area of (p, q, (x, y)).
float cross(const SurfacePoint& p, const SurfacePoint& q, float x, float y) {
  return (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
}

}  // namespace

SeedPlanes::SeedPlanes(const std::vector<SurfacePoint>& points, cv::Size size) {
  const cv::Rect area(0, 0, size.width, size.height);
  cv::Subdiv2D subdivision(area);
  std::map<Position, SurfacePoint> known;
  for (const SurfacePoint& p : points) {
    const bool inside = p.x >= 0.0F && p.y >= 0.0F && p.x < static_cast<float>(size.width) &&
                        p.y < static_cast<float>(size.height) && std::isfinite(p.d);
    if (inside && known.emplace(Position(p.x, p.y), p).second) subdivision.insert(cv::Point2f(p.x, p.y));
  }
  if (known.size() < 3) return;
  std::vector<cv::Vec6f> triangles;
  subdivision.getTriangleList(triangles);
  triangle_ = cv::Mat(size, CV_32SC1, cv::Scalar(-1));
  for (const cv::Vec6f& t : triangles) {
    const auto p = known.find({t[0], t[1]});
    const auto q = known.find({t[2], t[3]});
    const auto r = known.find({t[4], t[5]});
    // The corners of the subdivision's own outer triangle are no seeds.
    if (p != known.end() && q != known.end() && r != known.end()) draw(p->second, q->second, r->second);
  }
}

bool SeedPlanes::planeAt(int x, int y, Plane& plane) const {
  if (empty()) return false;
  const int index = triangle_.at<int>(y, x);
  if (index < 0) return false;
  plane = planes_[index];
  return true;
}

void SeedPlanes::draw(const SurfacePoint& p, const SurfacePoint& q, const SurfacePoint& r) {
  const float area = cross(p, q, r.x, r.y);
  if (std::fabs(area) < kSmallestArea) return;
  const float a = ((q.d - p.d) * (r.y - p.y) - (r.d - p.d) * (q.y - p.y)) / area;
  const float b = ((r.d - p.d) * (q.x - p.x) - (q.d - p.d) * (r.x - p.x)) / area;
  const int index = static_cast<int>(planes_.size());
  planes_.push_back(Plane::through(p.x, p.y, p.d, a, b));
  const int left = static_cast<int>(std::ceil(std::min({p.x, q.x, r.x})));
  const int right = static_cast<int>(std::floor(std::max({p.x, q.x, r.x})));
  const int top = static_cast<int>(std::ceil(std::min({p.y, q.y, r.y})));
  const int bottom = static_cast<int>(std::floor(std::max({p.y, q.y, r.y})));
  const float sign = area > 0.0F ? 1.0F : -1.0F;
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const float fx = static_cast<float>(x);
      const float fy = static_cast<float>(y);
      const bool inside = sign * cross(p, q, fx, fy) >= 0.0F && sign * cross(q, r, fx, fy) >= 0.0F &&
                          sign * cross(r, p, fx, fy) >= 0.0F;
      if (inside) triangle_.at<int>(y, x) = index;
    }
  }
}

}  // namespace fdp_stereo::local_expansion
