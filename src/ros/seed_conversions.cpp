// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "seed_conversions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <stdexcept>

#include <sensor_msgs/image_encodings.h>

namespace fdp_stereo {
namespace {

namespace enc = sensor_msgs::image_encodings;

/// A point this much farther than one beside it is behind it.
constexpr double kHiddenRatio = 1.1;

std::uint32_t fieldOffset(const sensor_msgs::PointCloud2& cloud, const std::string& name, const std::string& topic) {
  for (const auto& field : cloud.fields) {
    if (field.name != name) continue;
    if (field.datatype != sensor_msgs::PointField::FLOAT32) {
      throw std::invalid_argument(topic + ": field " + name + " has data type " + std::to_string(field.datatype) +
                                  ", not FLOAT32");
    }
    if (static_cast<std::uint64_t>(field.offset) + sizeof(float) > cloud.point_step) {
      throw std::invalid_argument(topic + ": field " + name + " at byte " + std::to_string(field.offset) +
                                  " lies outside a point of " + std::to_string(cloud.point_step) + " bytes");
    }
    return field.offset;
  }
  throw std::invalid_argument(topic + ": no field " + name + "; a cloud with x, y, z is needed");
}

void checkCloud(const sensor_msgs::PointCloud2& cloud, const std::string& topic) {
  const std::uint64_t row = static_cast<std::uint64_t>(cloud.width) * cloud.point_step;
  const std::uint64_t needed =
      cloud.height == 0 ? 0 : static_cast<std::uint64_t>(cloud.row_step) * (cloud.height - 1) + row;
  if (cloud.is_bigendian != 0) throw std::invalid_argument(topic + ": big-endian clouds are not read");
  if ((cloud.height > 1 && cloud.row_step < row) || cloud.data.size() < needed) {
    throw std::invalid_argument(topic + ": " + std::to_string(cloud.data.size()) + " bytes are too few for " +
                                std::to_string(cloud.width) + " x " + std::to_string(cloud.height) + " points of " +
                                std::to_string(cloud.point_step) + " bytes");
  }
}

float readFloat(const std::uint8_t* from) {
  float value = 0.0F;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

/// The camera of a depth image, whose camera_info may be that of the full resolution.
PinholeCamera depthCamera(const sensor_msgs::CameraInfo& info, cv::Size size, const std::string& topic) {
  const DescribedSize described = describedSize(info);
  PinholeCamera camera = pinholeCamera(info, size);
  const double values[] = {camera.fx, camera.fy, camera.cx, camera.cy, camera.tx, camera.ty};
  const bool finite = std::all_of(std::begin(values), std::end(values), [](double v) { return std::isfinite(v); });
  if (!finite || camera.fx <= 0.0 || camera.fy <= 0.0) {
    throw std::invalid_argument(topic + ": fx = " + std::to_string(camera.fx) + ", fy = " + std::to_string(camera.fy) +
                                " in its camera_info; calibrate the depth camera");
  }
  if (described.width == 0) return camera;
  const double scale = static_cast<double>(size.width) / described.width;
  return scale == 1.0 ? camera : camera.scaled(scale, scale);
}

/// The nearest depth per square of the image.
class DepthGrid {
 public:
  DepthGrid(cv::Size image, double spacing)
      : spacing_(std::max(1.0, spacing)),
        cols_(static_cast<int>(image.width / spacing_) + 1),
        rows_(static_cast<int>(image.height / spacing_) + 1),
        depth_(static_cast<std::size_t>(cols_) * static_cast<std::size_t>(rows_),
               std::numeric_limits<double>::infinity()) {}

  void add(double u, double v, double z) { at(column(u), row(v)) = std::min(at(column(u), row(v)), z); }
  /// The nearest of its square, and not behind one beside it.
  bool visible(double u, double v, double z) {
    if (z > at(column(u), row(v))) return false;
    for (int r = std::max(0, row(v) - 1); r <= std::min(rows_ - 1, row(v) + 1); ++r) {
      for (int c = std::max(0, column(u) - 1); c <= std::min(cols_ - 1, column(u) + 1); ++c) {
        if (z > kHiddenRatio * at(c, r)) return false;
      }
    }
    return true;
  }

 private:
  int column(double u) const { return static_cast<int>(u / spacing_); }
  int row(double v) const { return static_cast<int>(v / spacing_); }
  double& at(int c, int r) { return depth_[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols_) + c]; }

  double spacing_;
  int cols_;
  int rows_;
  std::vector<double> depth_;
};

}  // namespace

Points pointsOfCloud(const sensor_msgs::PointCloud2& cloud, const std::string& topic) {
  const std::uint32_t x = fieldOffset(cloud, "x", topic);
  const std::uint32_t y = fieldOffset(cloud, "y", topic);
  const std::uint32_t z = fieldOffset(cloud, "z", topic);
  checkCloud(cloud, topic);
  Points points;
  if (cloud.width == 0) return points;  // a header may claim any number of rows of nothing
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    const std::uint8_t* point = cloud.data.data() + static_cast<std::size_t>(row) * cloud.row_step;
    for (std::uint32_t i = 0; i < cloud.width; ++i, point += cloud.point_step) {
      const Eigen::Vector3d p(readFloat(point + x), readFloat(point + y), readFloat(point + z));
      if (p.allFinite()) points.push_back(p);
    }
  }
  return points;
}

Points pointsOfDepth(const sensor_msgs::Image& depth, const sensor_msgs::CameraInfo& info, int stride,
                     const std::string& topic) {
  const bool millimetres = depth.encoding == enc::TYPE_16UC1 || depth.encoding == enc::MONO16;
  cv::Mat metres;
  if (millimetres) {
    decodeImage(depth, topic).convertTo(metres, CV_32F, 1e-3);
  } else {
    metres = decodeFloatImage(depth, topic);
  }
  const PinholeCamera camera = depthCamera(info, metres.size(), topic);
  Points points;
  for (int y = 0; y < metres.rows; y += stride) {
    for (int x = 0; x < metres.cols; x += stride) {
      const float z = metres.at<float>(y, x);
      if (std::isfinite(z) && z > 0.0F) points.push_back(camera.backProject(x, y, z));
    }
  }
  return points;
}

Points pointsOfDisparity(const stereo_msgs::DisparityImage& disparity, const PinholeCamera& left, int stride,
                         const std::string& topic) {
  const double scale = static_cast<double>(disparity.f) * disparity.T;
  if (!std::isfinite(scale) || scale <= 0.0) {
    throw std::invalid_argument(topic + ": f = " + std::to_string(disparity.f) +
                                ", T = " + std::to_string(disparity.T) + " give no depth; both must be > 0");
  }
  const cv::Mat map = fromDisparityMessage(disparity, {}, topic);
  const PinholeCamera camera =
      left.scaled(static_cast<double>(map.cols) / left.size.width, static_cast<double>(map.rows) / left.size.height);
  Points points;
  for (int y = 0; y < map.rows; y += stride) {
    for (int x = 0; x < map.cols; x += stride) {
      const float d = map.at<float>(y, x);
      if (d > 0.0F) points.push_back(camera.backProject(x, y, scale / d));
    }
  }
  return points;
}

Seeds projectSeeds(const Points& points, const PinholeCamera& left, const StereoGeometry& geometry,
                   const SeedQuality& quality, SeedSource source) {
  struct Projected {
    double u, v, z;
  };
  std::vector<Projected> inside;
  DepthGrid grid(left.size, quality.spacing_px);
  for (const Eigen::Vector3d& p : points) {
    if (!(p.z() > 0.0)) continue;
    const Eigen::Vector2d pixel = left.project(p);
    const double u = pixel.x();
    const double v = pixel.y();
    if (!(u >= 0.0 && v >= 0.0 && u <= left.size.width - 1 && v <= left.size.height - 1)) continue;
    inside.push_back({u, v, p.z()});
    grid.add(u, v, p.z());
  }
  Seeds seeds;
  for (const Projected& p : inside) {
    if (!grid.visible(p.u, p.v, p.z)) continue;
    const double d = geometry.focal_px * geometry.baseline_m / p.z + geometry.cx_offset_px;
    seeds.push_back({static_cast<float>(p.u), static_cast<float>(p.v), static_cast<float>(d),
                     static_cast<float>(quality.trust), source});
  }
  return seeds;
}

}  // namespace fdp_stereo
