// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "text.hpp"

namespace fdp_stereo {
namespace {

namespace enc = sensor_msgs::image_encodings;

constexpr int kNoConversion = -1;
constexpr std::uint64_t kMaxSidePx = 65535;

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

void fillImage(const cv::Mat& image, const std_msgs::Header& header, sensor_msgs::Image& message) {
  const std::size_t row_bytes = image.elemSize() * static_cast<std::size_t>(image.cols);
  message.header = header;
  message.height = static_cast<std::uint32_t>(image.rows);
  message.width = static_cast<std::uint32_t>(image.cols);
  message.encoding = encodingOf(image.type());
  message.is_bigendian = hostIsBigEndian() ? 1 : 0;
  message.step = static_cast<std::uint32_t>(row_bytes);
  message.data.resize(row_bytes * static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) {
    const auto* row = image.ptr<std::uint8_t>(y);
    std::copy(row, row + row_bytes, message.data.data() + static_cast<std::size_t>(y) * row_bytes);
  }
}

}  // namespace

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

  fillImage(disparity, header, message->image);
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

cv::Mat depthError(const cv::Mat& disparity, const cv::Mat& sigma, const StereoGeometry& geometry) {
  cv::Mat error(disparity.size(), CV_32FC1);
  const double scale = 1.0 / (geometry.focal_px * geometry.baseline_m);
  for (int y = 0; y < error.rows; ++y) {
    const auto *d = disparity.ptr<float>(y), *s = sigma.ptr<float>(y);
    auto* row = error.ptr<float>(y);
    for (int x = 0; x < error.cols; ++x) {
      const double z = geometry.depth(d[x]);
      row[x] = std::isfinite(z) ? static_cast<float>(z * z * s[x] * scale) : kInvalidDisparity;
    }
  }
  return error;
}

sensor_msgs::ImagePtr toDepthMessage(const cv::Mat& disparity, const std_msgs::Header& header,
                                     const StereoGeometry& geometry, DepthLimits limits) {
  sensor_msgs::ImagePtr message = toImageMessage(disparity, header);
  cv::Mat depth(disparity.size(), CV_32FC1, message->data.data());
  for (int y = 0; y < depth.rows; ++y) {
    auto* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      const double z = geometry.depth(row[x]);
      const bool inside = std::isfinite(z) && z >= limits.min_m && (limits.max_m <= 0.0 || z <= limits.max_m);
      row[x] = inside ? static_cast<float>(z) : kInvalidDisparity;
    }
  }
  return message;
}

sensor_msgs::ImagePtr toImageMessage(const cv::Mat& image, const std_msgs::Header& header) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  fillImage(image, header, *message);
  return message;
}

}  // namespace fdp_stereo
