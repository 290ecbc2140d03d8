// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

#include "fdp_stereo/io.hpp"
#include "io/bytes.hpp"

namespace fdp_stereo {
namespace {

constexpr double kPngScale = 256.0;
constexpr std::size_t kMaxPfmHeader = 4096;  // bytes, comments included

bool hostIsLittleEndian() {
  const std::uint16_t one = 1;
  std::uint8_t first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

float floatAt(const char* bytes, bool swap) {
  std::array<char, 4> own{};
  std::memcpy(own.data(), bytes, own.size());
  if (swap) std::reverse(own.begin(), own.end());
  float value = 0.0F;
  std::memcpy(&value, own.data(), own.size());
  return value;
}

bool isSpace(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

struct PfmHeader {
  std::int64_t width = 0;
  std::int64_t height = 0;
  double scale = 0.0;     ///< negative = little endian
  std::size_t bytes = 0;  ///< up to the end of the scale
  std::size_t dataBytes() const { return 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// The next field, after white space and comments; moves `at` behind it.
std::string nextField(const std::string& bytes, std::size_t& at) {
  while (at < bytes.size() && (isSpace(bytes[at]) || bytes[at] == '#')) {
    at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
  }
  const std::size_t begin = at;
  while (at < bytes.size() && !isSpace(bytes[at])) ++at;
  return bytes.substr(begin, at - begin);
}

template <typename Number>
bool parse(const std::string& text, Number& number) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  return in >> number && in.eof();
}

PfmHeader parsePfmHeader(const std::string& bytes, const std::string& path) {
  PfmHeader header;
  const std::string magic = nextField(bytes, header.bytes);
  if (magic != "Pf") fail(path, magic == "PF" ? "PFM has 3 channels, not 1" : "not a PFM");
  const std::string width = nextField(bytes, header.bytes);
  const std::string height = nextField(bytes, header.bytes);
  const std::string scale = nextField(bytes, header.bytes);
  if (!parse(width, header.width) || !parse(height, header.height) || !parse(scale, header.scale) ||
      header.scale == 0.0) {
    fail(path, "broken PFM header");
  }
  checkSides(path, header.width, header.height);
  return header;
}

/// One white-space character ends the header, as netpbm has it. Some programs end the line with CR LF, or write a
/// blank or a comment before its end: the data begin after such a line where the file is long enough for that.
std::size_t pfmDataBegin(const std::string& bytes, const PfmHeader& header) {
  const std::size_t end = bytes.find('\n', header.bytes);
  if (end == std::string::npos || end + 1 + header.dataBytes() > bytes.size()) return header.bytes + 1;
  const std::size_t text = bytes.find_first_not_of(" \t\r", header.bytes);
  return text == end || bytes[text] == '#' ? end + 1 : header.bytes + 1;
}

cv::Mat readPfm(const std::string& path) {
  std::ifstream file = openFile(path);
  std::string bytes;
  appendBytes(file, kMaxPfmHeader, bytes);
  const PfmHeader header = parsePfmHeader(bytes, path);
  appendBytes(file, header.dataBytes(), bytes);
  const std::size_t begin = pfmDataBegin(bytes, header);
  if (begin + header.dataBytes() > bytes.size()) {
    fail(path, "truncated: " + sizeText(header.width, header.height) + " floats do not fit into the file");
  }
  cv::Mat map(static_cast<int>(header.height), static_cast<int>(header.width), CV_32FC1);
  const bool swap = (header.scale < 0.0) != hostIsLittleEndian();
  const char* from = &bytes[begin];
  for (int y = map.rows - 1; y >= 0; --y) {
    for (int x = 0; x < map.cols; ++x, from += 4) {
      const float d = floatAt(from, swap);
      map.at<float>(y, x) = std::isfinite(d) ? d : kInvalidDisparity;
    }
  }
  return map;
}

void writePfm(const std::string& path, const cv::Mat& disparity) {
  std::string bytes = "Pf\n" + std::to_string(disparity.cols) + " " + std::to_string(disparity.rows) +
                      (hostIsLittleEndian() ? "\n-1.0\n" : "\n1.0\n");
  bytes.reserve(bytes.size() + 4 * disparity.total());
  for (int y = disparity.rows - 1; y >= 0; --y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const float d = disparity.at<float>(y, x);
      const float value = std::isfinite(d) ? d : std::numeric_limits<float>::infinity();
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  writeFile(path, bytes);
}

/// One channel of a picture that stores grey as three equal ones.
cv::Mat greyOf(const cv::Mat& picture, const std::string& path) {
  std::array<cv::Mat, 3> channels;
  cv::split(picture, channels.data());
  if (cv::norm(channels[0], channels[1], cv::NORM_INF) > 0.0 ||
      cv::norm(channels[1], channels[2], cv::NORM_INF) > 0.0) {
    fail(path, "a disparity PNG must be grey");
  }
  return channels[0];
}

cv::Mat readPngDisparity(const std::string& path, double scale) {
  cv::Mat raw = readImage(path);
  if (raw.channels() == 3) raw = greyOf(raw, path);
  raw.convertTo(raw, CV_32F);
  for (int y = 0; y < raw.rows; ++y) {
    float* row = raw.ptr<float>(y);
    std::transform(row, row + raw.cols, row,
                   [&](float v) { return v > 0.0F ? v / static_cast<float>(scale) : kInvalidDisparity; });
  }
  return raw;
}

void writePngDisparity(const std::string& path, const cv::Mat& disparity) {
  cv::Mat raw(disparity.size(), CV_16UC1);
  for (int y = 0; y < raw.rows; ++y) {
    for (int x = 0; x < raw.cols; ++x) {
      const float d = disparity.at<float>(y, x);
      const double value = std::isfinite(d) ? std::max(1.0, std::round(d * kPngScale)) : 0.0;
      if (d < 0.0F || value > 65535.0)
        fail(path, "16-bit PNG cannot hold a disparity of " + std::to_string(d) + " px, use .pfm");
      raw.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(value);
    }
  }
  writeImage(path, raw);
}

}  // namespace

cv::Mat readDisparity(const std::string& path, double png_scale) {
  if (!(png_scale > 0.0) || !std::isfinite(png_scale)) {
    throw std::invalid_argument("png_scale = " + std::to_string(png_scale) + ": must be above 0");
  }
  const std::string type = extension(path);
  if (type == ".pfm") return readPfm(path);
  if (type == ".png") return readPngDisparity(path, png_scale);
  fail(path, "a disparity map must be .pfm or .png");
}

bool isDisparityName(const std::string& path) { return extension(path) == ".pfm" || extension(path) == ".png"; }

void writeDisparity(const std::string& path, const cv::Mat& disparity) {
  if (disparity.empty() || disparity.type() != CV_32FC1)
    throw std::invalid_argument("a disparity map must be CV_32FC1");
  const std::string type = extension(path);
  if (type == ".pfm") return writePfm(path, disparity);
  if (type == ".png") return writePngDisparity(path, disparity);
  fail(path, "a disparity map must be .pfm or .png");
}

}  // namespace fdp_stereo
