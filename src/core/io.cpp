// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/io.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <locale>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

namespace fdp_stereo {
namespace {

constexpr double kPngScale = 256.0;
constexpr std::uint64_t kMaxDeflateRatio = 1032;  // of the deflate format: a shorter file cannot hold the image
constexpr std::size_t kMaxSeeds = 10'000'000;

[[noreturn]] void fail(const std::string& path, const std::string& problem) {
  throw std::runtime_error(path + ": " + problem);
}

std::string extension(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] == '/') return "";
  std::string text = path.substr(dot);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return text;
}

std::ifstream open(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || file.peek() == std::ifstream::traits_type::eof()) fail(path, "missing, empty or not readable");
  return file;
}

std::uint64_t remainingBytes(std::ifstream& file) {
  const auto here = file.tellg();
  file.seekg(0, std::ios::end);
  const auto end = file.tellg();
  file.seekg(here);
  return here < 0 || end < here ? 0 : static_cast<std::uint64_t>(end - here);
}

std::string sizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

void checkSize(const std::string& path, std::int64_t width, std::int64_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide) return;
  fail(path, "claims " + sizeText(width, height) + " px, sides must be 1 to " + std::to_string(kMaxImageSide));
}

bool hostIsLittleEndian() {
  const std::uint16_t one = 1;
  std::uint8_t first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

void swapBytes(float& value) {
  std::array<char, 4> bytes{};
  std::memcpy(bytes.data(), &value, 4);
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&value, bytes.data(), 4);
}

struct PfmHeader {
  std::int64_t width = 0;
  std::int64_t height = 0;
  double scale = 0.0;  // negative = little endian
};

/// The next header line that is no comment.
std::string headerLine(std::ifstream& file) {
  std::string line;
  do {
    line.clear();
    for (char c = 0; line.size() < 256 && file.get(c) && c != '\n';) line += c;
  } while (file && !line.empty() && line[0] == '#');
  return line;
}

PfmHeader readPfmHeader(std::ifstream& file, const std::string& path) {
  const std::string magic = headerLine(file);
  if (magic.compare(0, 2, "Pf") != 0)
    fail(path, magic.compare(0, 2, "PF") == 0 ? "PFM has 3 channels, not 1" : "not a PFM");
  PfmHeader header;
  std::istringstream size(headerLine(file));
  std::istringstream scale(headerLine(file));
  scale.imbue(std::locale::classic());
  if (!(size >> header.width >> header.height) || !(scale >> header.scale) || header.scale == 0.0) {
    fail(path, "broken PFM header");
  }
  checkSize(path, header.width, header.height);
  const std::uint64_t wanted =
      4ULL * static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
  if (remainingBytes(file) < wanted) {
    fail(path, "truncated: " + sizeText(header.width, header.height) + " floats do not fit into the file");
  }
  return header;
}

cv::Mat readPfm(const std::string& path) {
  std::ifstream file = open(path);
  const PfmHeader header = readPfmHeader(file, path);
  cv::Mat map(static_cast<int>(header.height), static_cast<int>(header.width), CV_32FC1);
  const bool swap = (header.scale < 0.0) != hostIsLittleEndian();
  for (int y = map.rows - 1; y >= 0; --y) {
    float* row = map.ptr<float>(y);
    if (!file.read(reinterpret_cast<char*>(row), 4LL * map.cols)) fail(path, "truncated");
    for (int x = 0; x < map.cols; ++x) {
      if (swap) swapBytes(row[x]);
      if (!std::isfinite(row[x])) row[x] = kInvalidDisparity;
    }
  }
  return map;
}

void writePfm(const std::string& path, const cv::Mat& disparity) {
  std::ofstream file(path, std::ios::binary);
  file << "Pf\n" << disparity.cols << ' ' << disparity.rows << (hostIsLittleEndian() ? "\n-1.0\n" : "\n1.0\n");
  std::vector<float> row(static_cast<std::size_t>(disparity.cols));
  for (int y = disparity.rows - 1; y >= 0; --y) {
    const float* source = disparity.ptr<float>(y);
    std::transform(source, source + disparity.cols, row.begin(),
                   [](float d) { return std::isfinite(d) ? d : std::numeric_limits<float>::infinity(); });
    file.write(reinterpret_cast<const char*>(row.data()), 4LL * disparity.cols);
  }
  file.close();
  if (!file) fail(path, "cannot be written");
}

std::uint32_t bigEndian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

/// Walks the chunks of a PNG: the decoder below prints to stderr and allocates before it finds out.
void checkPng(std::ifstream& file, const std::string& path) {
  std::array<char, 33> head{};
  const std::uint64_t bytes = remainingBytes(file);
  if (!file.read(head.data(), head.size())) fail(path, "truncated PNG");
  const std::int64_t width = bigEndian(&head[16]);
  const std::int64_t height = bigEndian(&head[20]);
  checkSize(path, width, height);
  if (static_cast<std::uint64_t>(width * height) > bytes * kMaxDeflateRatio * 8) {
    fail(path, "PNG claims " + sizeText(width, height) + " px, more than the file can hold");
  }
  std::array<char, 8> chunk{};
  while (file.read(chunk.data(), chunk.size())) {
    if (std::memcmp(&chunk[4], "IEND", 4) == 0) return;
    file.seekg(static_cast<std::streamoff>(bigEndian(chunk.data())) + 4, std::ios::cur);
  }
  fail(path, "truncated PNG");
}

/// Formats with decoders that stand any content; OpenCV knows others by their content, and one of them ends the
/// process.
void checkFormat(const std::string& path) {
  using namespace std::string_literals;
  static const std::string kPng = "\x89PNG\r\n\x1a\n";
  static const std::array<std::string, 5> kOthers = {"\xff\xd8\xff", "BM", "II*\0"s, "MM\0*"s, "RIFF"};
  std::ifstream file = open(path);
  std::string magic(kPng.size(), '\0');
  file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  file.clear();
  file.seekg(0);
  if (magic == kPng) return checkPng(file, path);
  const auto starts = [&](const std::string& with) { return magic.compare(0, with.size(), with) == 0; };
  const bool pnm = magic[0] == 'P' && magic[1] >= '1' && magic[1] <= '6';
  if (!pnm && std::none_of(kOthers.begin(), kOthers.end(), starts)) {
    fail(path, "not readable as an image: not PNG, JPEG, TIFF, BMP, WebP or PNM");
  }
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

bool parseSeed(const std::string& line, Seed& seed) {
  std::istringstream in(line);
  in.imbue(std::locale::classic());
  if (!(in >> seed.x >> seed.y >> seed.d)) return false;
  if (in >> std::ws; in.eof()) return true;
  return in >> seed.trust && (in >> std::ws).eof() && seed.trust >= 0.0F && seed.trust <= 1.0F;
}

Seeds readTextSeeds(const std::string& path) {
  std::ifstream file = open(path);
  Seeds seeds;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    Seed seed;
    seed.source = SeedSource::kFile;
    if (!parseSeed(line, seed)) fail(path + ":" + std::to_string(number), "must be 'x y d [trust 0..1]'");
    if (seeds.size() == kMaxSeeds) fail(path, "more than " + std::to_string(kMaxSeeds) + " seeds");
    seeds.push_back(seed);
  }
  return seeds;
}

}  // namespace

cv::Mat readDisparity(const std::string& path, double png_scale) {
  if (!(png_scale > 0.0)) throw std::invalid_argument("png_scale = " + std::to_string(png_scale) + ": must be above 0");
  const std::string type = extension(path);
  if (type == ".pfm") return readPfm(path);
  if (type == ".png") return readPngDisparity(path, png_scale);
  fail(path, "a disparity map must be .pfm or .png");
}

void writeDisparity(const std::string& path, const cv::Mat& disparity) {
  if (disparity.empty() || disparity.type() != CV_32FC1)
    throw std::invalid_argument("a disparity map must be CV_32FC1");
  const std::string type = extension(path);
  if (type == ".pfm") return writePfm(path, disparity);
  if (type == ".png") return writePngDisparity(path, disparity);
  fail(path, "a disparity map must be .pfm or .png");
}

cv::Mat readImage(const std::string& path) {
  checkFormat(path);
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    fail(path, "not readable as an image: " + error.err);
  }
  if (image.empty()) fail(path, "not readable as an image");
  checkSize(path, image.cols, image.rows);
  if (image.depth() != CV_8U && image.depth() != CV_16U) fail(path, "pixels must have 8 or 16 bits");
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
  if (image.channels() != 1 && image.channels() != 3) fail(path, "must have 1 or 3 channels");
  return image;
}

void writeImage(const std::string& path, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception& error) {
    fail(path, "cannot be written: " + error.err);
  }
  if (!written) fail(path, "cannot be written");
}

Seeds readSeeds(const std::string& path) {
  const std::string type = extension(path);
  if (type != ".pfm" && type != ".png") return readTextSeeds(path);
  const cv::Mat map = readDisparity(path);
  Seeds seeds;
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const float d = map.at<float>(y, x);
      if (std::isnan(d)) continue;
      Seed seed;
      seed.x = static_cast<float>(x);
      seed.y = static_cast<float>(y);
      seed.d = d;
      seed.source = SeedSource::kFile;
      seeds.push_back(seed);
    }
  }
  return seeds;
}

cv::Mat noneMask(const cv::Mat& map) {
  // Not map != map: OpenCV compares four values at once with an instruction for which NaN differs from nothing.
  return ~(map == map);
}

cv::Mat colorize(const cv::Mat& disparity, DisparityRange range) {
  cv::Mat grey(disparity.size(), CV_8UC1);
  const float span = static_cast<float>(std::max(1, range.count - 1));
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const float d = disparity.at<float>(y, x);
      const float level = std::isnan(d) ? 0.0F : 255.0F * (d - static_cast<float>(range.min)) / span;
      grey.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(level);
    }
  }
  cv::Mat colors;
  cv::applyColorMap(grey, colors, cv::COLORMAP_TURBO);
  colors.setTo(cv::Scalar::all(0), noneMask(disparity));
  return colors;
}

cv::Mat confidenceToGrey(const cv::Mat& confidence) {
  cv::Mat grey;
  confidence.convertTo(grey, CV_8U, 255.0);
  grey.setTo(0, noneMask(confidence));
  return grey;
}

}  // namespace fdp_stereo
