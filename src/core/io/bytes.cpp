// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/bytes.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "fdp_stereo/io.hpp"

namespace fdp_stereo {

namespace fs = std::filesystem;

void fail(const std::string& name, const std::string& problem) { throw std::runtime_error(name + ": " + problem); }

std::string extension(const std::string& path) {
  std::string text = fs::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return text;
}

std::ifstream openFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || file.peek() == std::ifstream::traits_type::eof()) fail(path, "missing, empty or not readable");
  return file;
}

void appendBytes(std::istream& stream, std::size_t most, std::string& bytes) {
  constexpr std::size_t kBlock = 1U << 20;
  while (most > 0 && stream) {
    const std::size_t before = bytes.size();
    bytes.resize(before + std::min(most, kBlock));
    stream.read(&bytes[before], static_cast<std::streamsize>(bytes.size() - before));
    const auto got = static_cast<std::size_t>(stream.gcount());
    bytes.resize(before + got);
    most -= got;
  }
}

std::string sizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

void checkSides(const std::string& name, std::int64_t width, std::int64_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide) return;
  fail(name, "claims " + sizeText(width, height) + " px, sides must be 1 to " + std::to_string(kMaxImageSide));
}

std::uint32_t bigEndian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  if (at + count > bytes.size()) return 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

std::uint32_t littleEndian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  if (at + count > bytes.size()) return 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

void writeFile(const std::string& path, std::string_view bytes) {
  std::error_code none;
  const bool in_place = fs::exists(path, none) && !fs::is_regular_file(path, none);  // a pipe or a device
  const std::string final = fs::is_symlink(path, none) && !in_place ? fs::weakly_canonical(path).string() : path;
  const std::string name = in_place ? path : final + ".partial";
  errno = 0;
  std::ofstream file(name, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code problem = file ? std::error_code() : std::error_code(errno, std::generic_category());
  if (file && !in_place) fs::rename(name, final, problem);
  if (file && !problem) return;
  if (!in_place) fs::remove(name, none);
  fail(path, "cannot be written" + (problem ? ": " + problem.message() : ""));
}

}  // namespace fdp_stereo
