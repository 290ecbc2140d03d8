// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "fdp_stereo/io.hpp"
#include "io/bytes.hpp"

namespace fdp_stereo {
namespace {

constexpr std::size_t kMaxSeeds = 10'000'000;
constexpr std::size_t kLongestLine = 1000;

bool parseSeed(const std::string& line, Seed& seed) {
  std::istringstream in(line);
  in.imbue(std::locale::classic());
  if (!(in >> seed.x >> seed.y >> seed.d)) return false;
  if (in >> std::ws; in.eof()) return true;
  return in >> seed.trust && (in >> std::ws).eof() && seed.trust >= 0.0F && seed.trust <= 1.0F;
}

Seeds readTextSeeds(const std::string& path) {
  std::ifstream file = openFile(path);
  Seeds seeds;
  std::array<char, kLongestLine> buffer{};
  for (int number = 1; file.getline(buffer.data(), buffer.size()) || file.gcount() > 0; ++number) {
    const std::string place = path + ":" + std::to_string(number);
    if (!file && !file.eof()) fail(place, "longer than " + std::to_string(kLongestLine) + " characters");
    const std::string text(buffer.data());
    const std::string line = text.substr(0, text.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    Seed seed;
    seed.source = SeedSource::kFile;
    if (!parseSeed(line, seed)) fail(place, "must be 'x y d [trust 0..1]'");
    if (seeds.size() == kMaxSeeds) fail(path, "more than " + std::to_string(kMaxSeeds) + " seeds");
    seeds.push_back(seed);
  }
  return seeds;
}

Seeds seedsOfMap(const cv::Mat& map) {
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

}  // namespace

Seeds readSeeds(const std::string& path, cv::Size image_size) {
  const std::string type = extension(path);
  if (type != ".pfm" && type != ".png") return readTextSeeds(path);
  const cv::Mat map = readDisparity(path);
  if (!image_size.empty() && map.size() != image_size) {
    fail(path, "is " + sizeText(map.cols, map.rows) + " px, the left image " +
                   sizeText(image_size.width, image_size.height) +
                   " px; give a map of the image's size, or seeds as text");
  }
  return seedsOfMap(map);
}

}  // namespace fdp_stereo
