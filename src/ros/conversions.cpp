// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

namespace fdp_stereo {
namespace {

namespace enc = sensor_msgs::image_encodings;

constexpr int kNoConversion = -1;
/// Focal lengths of a rectified pair are equal; a calibration file may round them.
constexpr double kMaxFocalDifference = 0.01;
/// Rows that differ by more are no rectified pair.
constexpr double kMaxRowDifferencePx = 2.0;
constexpr std::uint64_t kMaxSidePx = 65535;
/// Beyond these a calibration is a mistake, and its values no longer fit the floats of a message.
constexpr double kMaxFocalPx = 1e6;
constexpr double kMaxCentrePx = 1e6;
constexpr double kMinBaselineM = 1e-4;
constexpr double kMaxBaselineM = 1e3;

template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  (stream << ... << parts);
  return stream.str();
}

template <typename... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  throw std::invalid_argument(text(parts...));
}

struct Encoding {
  std::string name;
  int type;        ///< of the raw pixels
  int conversion;  ///< cv::cvtColor code, or kNoConversion
};

/// bayer_xxyy names the first two rows from the left; OpenCV names rows 2 and 3, columns 2 and 3.
const std::vector<Encoding>& encodings() {
  static const std::vector<Encoding> table = {
      {enc::MONO8, CV_8UC1, kNoConversion},
      {enc::MONO16, CV_16UC1, kNoConversion},
      {enc::BGR8, CV_8UC3, kNoConversion},
      {enc::BGR16, CV_16UC3, kNoConversion},
      {enc::RGB8, CV_8UC3, cv::COLOR_RGB2BGR},
      {enc::RGB16, CV_16UC3, cv::COLOR_RGB2BGR},
      {enc::BGRA8, CV_8UC4, cv::COLOR_BGRA2BGR},
      {enc::BGRA16, CV_16UC4, cv::COLOR_BGRA2BGR},
      {enc::RGBA8, CV_8UC4, cv::COLOR_RGBA2BGR},
      {enc::RGBA16, CV_16UC4, cv::COLOR_RGBA2BGR},
      {enc::TYPE_8UC1, CV_8UC1, kNoConversion},
      {enc::TYPE_8UC3, CV_8UC3, kNoConversion},
      {enc::TYPE_16UC1, CV_16UC1, kNoConversion},
      {enc::TYPE_16UC3, CV_16UC3, kNoConversion},
      {enc::BAYER_RGGB8, CV_8UC1, cv::COLOR_BayerBG2BGR},
      {enc::BAYER_BGGR8, CV_8UC1, cv::COLOR_BayerRG2BGR},
      {enc::BAYER_GBRG8, CV_8UC1, cv::COLOR_BayerGR2BGR},
      {enc::BAYER_GRBG8, CV_8UC1, cv::COLOR_BayerGB2BGR},
      {enc::BAYER_RGGB16, CV_16UC1, cv::COLOR_BayerBG2BGR},
      {enc::BAYER_BGGR16, CV_16UC1, cv::COLOR_BayerRG2BGR},
      {enc::BAYER_GBRG16, CV_16UC1, cv::COLOR_BayerGR2BGR},
      {enc::BAYER_GRBG16, CV_16UC1, cv::COLOR_BayerGB2BGR},
      {enc::YUV422, CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
      {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUY2},
  };
  return table;
}

const Encoding& findEncoding(const std::string& name, const std::string& topic) {
  const auto& table = encodings();
  const auto found = std::find_if(table.begin(), table.end(), [&](const Encoding& e) { return e.name == name; });
  if (found == table.end()) {
    fail(topic, ": encoding ", quoteForLog(name),
         " is not a camera image; publish mono8, mono16, bgr8, rgb8, a bayer or a yuv422 encoding");
  }
  return *found;
}

bool hostIsBigEndian() {
  const std::uint16_t one = 1;
  return *reinterpret_cast<const std::uint8_t*>(&one) == 0;
}

/// Sizes that belong together, in 64 bits: a header cannot make the sums wrap.
void checkLayout(const sensor_msgs::Image& message, std::uint64_t pixel_bytes, const std::string& topic) {
  const std::uint64_t width = message.width;
  const std::uint64_t height = message.height;
  const std::uint64_t step = message.step;
  if (width == 0 || height == 0 || width > kMaxSidePx || height > kMaxSidePx) {
    fail(topic, ": image of ", width, " x ", height, " px; sides are 1 to ", kMaxSidePx, " px, check the driver");
  }
  if (step < width * pixel_bytes) {
    fail(topic, ": step ", step, " is less than a row of ", width * pixel_bytes, " bytes (", width, " px ",
         message.encoding, "); the driver must set step to the bytes of a row");
  }
  const std::uint64_t needed = step * (height - 1) + width * pixel_bytes;
  if (message.data.size() < needed) {
    fail(topic, ": data has ", message.data.size(), " bytes of the ", needed, " that ", width, " x ", height, " px ",
         message.encoding, " with step ", step, " need; the image is empty or truncated");
  }
}

cv::Mat swapBytes16(const cv::Mat& image) {
  cv::Mat swapped(image.size(), image.type());
  const int values = image.cols * image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint16_t>(y);
    auto* to = swapped.ptr<std::uint16_t>(y);
    for (int i = 0; i < values; ++i) to[i] = static_cast<std::uint16_t>((from[i] << 8) | (from[i] >> 8));
  }
  return swapped;
}

/// Rows of 16-bit pixels at odd addresses are copied: cv::Mat reads them as std::uint16_t.
cv::Mat wrapOrCopy(const sensor_msgs::Image& message, int type) {
  auto* data = const_cast<std::uint8_t*>(message.data.data());
  const int rows = static_cast<int>(message.height);
  const int cols = static_cast<int>(message.width);
  const std::size_t element = CV_ELEM_SIZE1(type);
  const bool aligned = message.step % element == 0 && reinterpret_cast<std::uintptr_t>(data) % element == 0;
  if (aligned && rows > 1) return cv::Mat(rows, cols, type, data, message.step);
  if (aligned) return cv::Mat(rows, cols, type, data);
  cv::Mat copy(rows, cols, type);
  for (int y = 0; y < rows; ++y) {
    const std::uint8_t* row = data + static_cast<std::size_t>(y) * message.step;
    std::copy(row, row + copy.elemSize() * static_cast<std::size_t>(cols), copy.ptr<std::uint8_t>(y));
  }
  return copy;
}

std::string encodingOf(int type) {
  switch (type) {
    case CV_8UC1:
      return enc::MONO8;
    case CV_8UC3:
      return enc::BGR8;
    case CV_16UC1:
      return enc::MONO16;
    case CV_16UC3:
      return enc::BGR16;
    case CV_32FC1:
      return enc::TYPE_32FC1;
    default:
      fail("an image of OpenCV type ", type, " cannot be published; 8 or 16 bit, grey or BGR, or 32FC1 can");
  }
}

/// P of one camera in px of the image as published: camera_info speaks of the full sensor.
struct Projection {
  double fx, fy, cx, cy, tx;
};

void checkProjection(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  for (std::size_t i = 0; i < info.P.size(); ++i) {
    if (!std::isfinite(info.P[i])) fail(topic, ": P[", i, "] = ", info.P[i], "; calibrate the camera anew");
  }
  if (std::all_of(info.P.begin(), info.P.end(), [](double p) { return p == 0.0; })) {
    fail(topic, ": P is all 0: the camera is not calibrated; run camera_calibration or load its file in the driver");
  }
  const auto possible = [](double focal_px) { return focal_px > 0.0 && focal_px <= kMaxFocalPx; };
  if (!possible(info.P[0]) || !possible(info.P[5])) {
    fail(topic, ": focal length P[0] = ", info.P[0], ", P[5] = ", info.P[5], " must be > 0 and at most ", kMaxFocalPx,
         " px; calibrate the camera");
  }
}

void checkSize(const sensor_msgs::CameraInfo& info, cv::Size image, const std::string& topic,
               std::vector<std::string>& warnings) {
  if (info.width == 0 || info.height == 0) {
    warnings.push_back(text(topic, ": size is not set (", info.width, " x ", info.height, "); taken as the image's, ",
                            image.width, " x ", image.height));
    return;
  }
  const std::uint64_t binning_x = std::max(1U, info.binning_x);
  const std::uint64_t binning_y = std::max(1U, info.binning_y);
  const std::uint64_t width = (info.roi.width != 0 ? info.roi.width : info.width) / binning_x;
  const std::uint64_t height = (info.roi.height != 0 ? info.roi.height : info.height) / binning_y;
  if (width != static_cast<std::uint64_t>(image.width) || height != static_cast<std::uint64_t>(image.height)) {
    fail(topic, ": describes ", width, " x ", height, " px (", info.width, " x ", info.height, ", binning ", binning_x,
         " x ", binning_y, ", roi ", info.roi.width, " x ", info.roi.height, ") but the image has ", image.width, " x ",
         image.height, "; load the calibration of this resolution, or set binning and roi");
  }
}

Projection project(const sensor_msgs::CameraInfo& info) {
  const double bx = std::max(1U, info.binning_x);
  const double by = std::max(1U, info.binning_y);
  return {info.P[0] / bx, info.P[5] / by, (info.P[2] - info.roi.x_offset) / bx, (info.P[6] - info.roi.y_offset) / by,
          info.P[3] / bx};
}

void checkCentre(const Projection& camera, const std::string& topic) {
  if (std::abs(camera.cx) <= kMaxCentrePx && std::abs(camera.cy) <= kMaxCentrePx) return;
  fail(topic, ": centre P[2] = ", camera.cx, ", P[6] = ", camera.cy, " px after binning and roi offset is beyond ",
       kMaxCentrePx, " px; correct them, or calibrate the camera anew");
}

void checkBaseline(const Projection& left, const Projection& right, const StereoTopics& topics) {
  if (right.tx == 0.0 && left.tx < 0.0) {
    fail(topics.left_info, ": P[3] = ", left.tx, " and ", topics.right_info,
         ": P[3] = 0: left and right are swapped; exchange the topics or cameras");
  }
  if (right.tx == 0.0) {
    fail(topics.right_info, ": P[3] = 0, so the baseline is 0: this is the calibration of a single or of the left ",
         "camera; run a stereo calibration");
  }
  if (right.tx > 0.0) {
    fail(topics.right_info, ": P[3] = ", right.tx, " > 0: left and right are swapped; exchange the topics or cameras");
  }
  const double baseline_m = -right.tx / right.fx;
  if (!(baseline_m >= kMinBaselineM && baseline_m <= kMaxBaselineM)) {
    fail(topics.right_info, ": P[3] = ", right.tx, " is a baseline of ", baseline_m, " m; ", kMinBaselineM, " to ",
         kMaxBaselineM, " m are possible: calibrate the cameras anew, in metres");
  }
}

void checkPair(const Projection& left, const Projection& right, const StereoTopics& topics,
               std::vector<std::string>& warnings) {
  const double focal_difference = std::abs(left.fx - right.fx) / right.fx;
  if (focal_difference > kMaxFocalDifference) {
    fail(topics.left_info, ": fx = ", left.fx, " px and ", topics.right_info, ": fx = ", right.fx,
         " px differ by more than 1 %; use the two files of one stereo calibration");
  }
  if (focal_difference > 0.0) {
    warnings.push_back(text(topics.left_info, ": fx = ", left.fx, " px differs from the right camera's ", right.fx,
                            " px, which is used"));
  }
  const double row_difference = left.cy - right.cy;
  if (std::abs(row_difference) > kMaxRowDifferencePx) {
    fail(topics.left_info, ": cy = ", left.cy, " px and ", topics.right_info, ": cy = ", right.cy,
         " px: the rows do not match; use the two files of one stereo calibration");
  }
  if (row_difference != 0.0) {
    warnings.push_back(text(topics.left_info, ": cy = ", left.cy, " px differs from the right camera's ", right.cy,
                            " px: rows are off by ", row_difference, " px"));
  }
}

}  // namespace

std::string quoteForLog(const std::string& text) {
  constexpr std::size_t kLongest = 40;
  std::string safe = text.substr(0, kLongest);
  std::replace_if(
      safe.begin(), safe.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + safe + "'";
}

cv::Mat decodeImage(const sensor_msgs::Image& message, const std::string& topic) {
  const Encoding& encoding = findEncoding(message.encoding, topic);
  checkLayout(message, CV_ELEM_SIZE(encoding.type), topic);
  if (encoding.type == CV_8UC2 && message.width % 2 != 0) {
    fail(topic, ": width ", message.width, " of a ", message.encoding, " image is odd; it must be even");
  }
  cv::Mat image = wrapOrCopy(message, encoding.type);
  if (image.depth() == CV_16U && (message.is_bigendian != 0) != hostIsBigEndian()) image = swapBytes16(image);
  if (encoding.conversion == kNoConversion) return image;
  cv::Mat converted;
  cv::cvtColor(image, converted, encoding.conversion);
  return converted;
}

StereoGeometry stereoGeometry(const sensor_msgs::CameraInfo& left, const sensor_msgs::CameraInfo& right,
                              cv::Size image_size, const StereoTopics& topics, std::vector<std::string>& warnings) {
  checkProjection(left, topics.left_info);
  checkProjection(right, topics.right_info);
  checkSize(left, image_size, topics.left_info, warnings);
  checkSize(right, image_size, topics.right_info, warnings);
  const Projection l = project(left);
  const Projection r = project(right);
  checkCentre(l, topics.left_info);
  checkCentre(r, topics.right_info);
  checkBaseline(l, r, topics);
  checkPair(l, r, topics, warnings);
  if (left.header.frame_id != right.header.frame_id) {
    warnings.push_back(text(topics.right_info, ": frame_id ", quoteForLog(right.header.frame_id),
                            " differs from the left's ", quoteForLog(left.header.frame_id),
                            "; a rectified pair shares the left optical frame"));
  }
  return {r.fx, -r.tx / r.fx, l.cx - r.cx};
}

stereo_msgs::DisparityImagePtr toDisparityMessage(const cv::Mat& disparity, const std_msgs::Header& header,
                                                  const StereoGeometry& geometry, DisparityRange range,
                                                  double delta_d) {
  auto message = boost::make_shared<stereo_msgs::DisparityImage>();
  message->header = header;
  message->f = static_cast<float>(geometry.focal_px);
  message->T = static_cast<float>(geometry.baseline_m);
  message->min_disparity = static_cast<float>(geometry.published(range.min));
  message->max_disparity = static_cast<float>(geometry.published(range.max()));
  message->delta_d = static_cast<float>(delta_d);

  message->image = *toImageMessage(disparity, header);
  cv::Mat values(disparity.size(), CV_32FC1, message->image.data.data());
  const float invalid = message->min_disparity - 1.0F;
  for (int y = 0; y < values.rows; ++y) {
    auto* row = values.ptr<float>(y);
    for (int x = 0; x < values.cols; ++x) {
      row[x] = std::isfinite(row[x]) ? static_cast<float>(geometry.published(row[x])) : invalid;
    }
  }

  const int first = std::clamp(range.min, 0, disparity.cols - 1);
  const int last = std::clamp(disparity.cols - 1 + range.max(), first, disparity.cols - 1);
  message->valid_window.x_offset = static_cast<std::uint32_t>(first);
  message->valid_window.width = static_cast<std::uint32_t>(last - first + 1);
  message->valid_window.height = static_cast<std::uint32_t>(disparity.rows);
  return message;
}

cv::Mat decodeFloatImage(const sensor_msgs::Image& message, const std::string& topic) {
  if (message.encoding != enc::TYPE_32FC1) {
    fail(topic, ": encoding ", quoteForLog(message.encoding), " is not 32FC1");
  }
  checkLayout(message, sizeof(float), topic);
  if ((message.is_bigendian != 0) != hostIsBigEndian()) fail(topic, ": floats with the bytes in the other order");
  return wrapOrCopy(message, CV_32FC1);
}

cv::Mat fromDisparityMessage(const stereo_msgs::DisparityImage& message, const StereoGeometry& geometry,
                             const std::string& topic) {
  cv::Mat disparity = decodeFloatImage(message.image, topic).clone();
  for (int y = 0; y < disparity.rows; ++y) {
    auto* row = disparity.ptr<float>(y);
    for (int x = 0; x < disparity.cols; ++x) {
      const bool valid = row[x] >= message.min_disparity && row[x] <= message.max_disparity;
      row[x] = valid ? static_cast<float>(row[x] + geometry.cx_offset_px) : kInvalidDisparity;
    }
  }
  return disparity;
}

sensor_msgs::ImagePtr toDepthMessage(const cv::Mat& disparity, const std_msgs::Header& header,
                                     const StereoGeometry& geometry, DepthLimits limits) {
  sensor_msgs::ImagePtr message = toImageMessage(disparity, header);
  cv::Mat depth(disparity.size(), CV_32FC1, message->data.data());
  const double scale = geometry.focal_px * geometry.baseline_m;
  for (int y = 0; y < depth.rows; ++y) {
    auto* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      const double d = geometry.published(row[x]);
      const double z = d > 0.0 ? scale / d : 0.0;
      const bool inside = z > 0.0 && z >= limits.min_m && (limits.max_m <= 0.0 || z <= limits.max_m);
      row[x] = inside ? static_cast<float>(z) : kInvalidDisparity;
    }
  }
  return message;
}

sensor_msgs::ImagePtr toImageMessage(const cv::Mat& image, const std_msgs::Header& header) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  const std::size_t row_bytes = image.elemSize() * static_cast<std::size_t>(image.cols);
  message->header = header;
  message->height = static_cast<std::uint32_t>(image.rows);
  message->width = static_cast<std::uint32_t>(image.cols);
  message->encoding = encodingOf(image.type());
  message->is_bigendian = hostIsBigEndian() ? 1 : 0;
  message->step = static_cast<std::uint32_t>(row_bytes);
  message->data.resize(row_bytes * static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) {
    const auto* row = image.ptr<std::uint8_t>(y);
    std::copy(row, row + row_bytes, message->data.data() + static_cast<std::size_t>(y) * row_bytes);
  }
  return message;
}

}  // namespace fdp_stereo
