// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <limits>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "fdp_stereo/io.hpp"
#include "io/bytes.hpp"
#include "io/image_header.hpp"

namespace fdp_stereo {
namespace {

constexpr std::size_t kMaxImageBytes = std::numeric_limits<int>::max();  // that OpenCV decodes

constexpr std::array<const char*, 10> kImageExtensions = {".png", ".jpg",  ".jpeg", ".tif", ".tiff",
                                                          ".bmp", ".webp", ".ppm",  ".pgm", ".pnm"};

/// Pixels as they are stored; what OpenCV throws becomes std::runtime_error or std::bad_alloc.
cv::Mat decode(std::string_view bytes, const std::string& name) {
  const cv::Mat wrapped(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  try {
    return cv::imdecode(wrapped, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    fail(name, "not readable as an image: " + error.err);
  }
}

}  // namespace

cv::Mat decodeImageFile(std::string_view bytes, const std::string& name, std::int64_t max_pixels) {
  if (bytes.empty()) fail(name, "not readable as an image: it is empty");
  if (bytes.size() > kMaxImageBytes) fail(name, "more than " + std::to_string(kMaxImageBytes) + " bytes");
  const cv::Size size = claimedImageSize(bytes, name);
  if (std::int64_t{size.width} * size.height > max_pixels) {
    fail(name, "claims " + sizeText(size.width, size.height) + " px, allowed are " + std::to_string(max_pixels));
  }
  cv::Mat image = decode(bytes, name);
  if (image.empty()) fail(name, "not readable as an image");
  if (image.depth() != CV_8U && image.depth() != CV_16U) fail(name, "pixels must have 8 or 16 bits");
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
  if (image.channels() != 1 && image.channels() != 3) fail(name, "must have 1 or 3 channels");
  return image;
}

cv::Mat readImage(const std::string& path) {
  std::ifstream file = openFile(path);
  std::string bytes;
  appendBytes(file, kImageMagicBytes, bytes);
  checkImageFormat(bytes, path);
  appendBytes(file, kMaxImageBytes, bytes);
  return decodeImageFile(bytes, path);
}

cv::Mat toMask(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  cv::Mat brightest = channels[0];
  for (const cv::Mat& channel : channels) brightest = cv::max(brightest, channel);
  return brightest >= (picture.depth() == CV_8U ? 128 : 32768);
}

cv::Mat readMask(const std::string& path, cv::Size size) {
  if (path.empty()) return {};
  cv::Mat mask = toMask(readImage(path));
  if (mask.size() == size) return mask;
  throw std::runtime_error(path + ": a mask of " + std::to_string(mask.cols) + " x " + std::to_string(mask.rows) +
                           " px, but the image has " + std::to_string(size.width) + " x " +
                           std::to_string(size.height));
}

bool isImageName(const std::string& path) {
  const std::string type = extension(path);
  return std::find(kImageExtensions.begin(), kImageExtensions.end(), type) != kImageExtensions.end();
}

void writeImage(const std::string& path, const cv::Mat& image) {
  if (image.empty()) throw std::invalid_argument(path + ": an image without pixels cannot be written");
  const std::string type = extension(path);
  if (!isImageName(path)) fail(path, "an image must be .png, .jpg, .tiff, .bmp, .webp or .ppm");
  const bool eight_bit = type == ".bmp" || type == ".webp" || type == ".jpg" || type == ".jpeg";
  if (image.depth() != CV_8U && eight_bit) fail(path, "holds 8 bits a channel, use .png or .tiff");
  std::vector<std::uint8_t> bytes;
  try {
    if (!cv::imencode(type, image, bytes)) fail(path, "cannot hold this image");
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    fail(path, "cannot hold this image: " + error.err);
  }
  writeFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace fdp_stereo
