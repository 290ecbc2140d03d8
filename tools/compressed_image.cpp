// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "compressed_image.hpp"

#include <sensor_msgs/image_encodings.h>
#include <opencv2/imgproc.hpp>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace enc = sensor_msgs::image_encodings;

/// "bgr8; jpeg compressed bgr8": the encoding of the original image, and the order of the colours in the file. Without
/// the latter red comes first; a format without ';' is the file's alone, where blue comes first for OpenCV.
struct Format {
  std::string encoding;
  bool red_first = false;
};

Format parseFormat(const std::string& text) {
  const std::size_t end = text.find(';');
  if (end == std::string::npos) return {};
  const std::string encoding = text.substr(0, end);
  return {encoding, enc::isColor(encoding) && text.find("compressed bgr", end) == std::string::npos};
}

}  // namespace

sensor_msgs::ImagePtr decompress(const sensor_msgs::CompressedImage& message, const std::string& topic,
                                 std::int64_t max_pixels) {
  const Format format = parseFormat(message.format);
  const std::string_view bytes(reinterpret_cast<const char*>(message.data.data()), message.data.size());
  cv::Mat image = decodeImageFile(bytes, topic, max_pixels);
  if (format.red_first && image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  sensor_msgs::ImagePtr decoded = toImageMessage(image, message.header);
  if (image.channels() == 1 && enc::isBayer(format.encoding)) {
    decoded->encoding =
        format.encoding.substr(0, format.encoding.find_first_of("0123456789")) + (image.depth() == CV_8U ? "8" : "16");
  }
  return decoded;
}

}  // namespace fdp_stereo
