// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/image_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <utility>

#include "io/bytes.hpp"

namespace fdp_stereo {
namespace {

using Bytes = std::string_view;

// Pixels that a byte can stand for at most, by the formats: 1032 bytes of 1-bit pixels by deflate; 8 x 8 by one bit; a
// run of 255 by two bytes; 1-bit pixels.
constexpr std::uint64_t kPngPixelsPerByte = 1032 * 8;
constexpr std::uint64_t kJpegPixelsPerByte = 64 * 8;
constexpr std::uint64_t kBmpPixelsPerByte = 128;
constexpr std::uint64_t kPnmPixelsPerByte = 8;

struct Claim {
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::uint64_t pixels_per_byte = 0;  ///< 0 = unknown

  /// Of several claims in one file decoders take the first or the last: the largest counts.
  void widen(std::uint32_t w, std::uint32_t h) {
    width = std::max<std::int64_t>(width, w);
    height = std::max<std::int64_t>(height, h);
  }
};

Claim pngClaim(Bytes bytes, const std::string& name) {
  constexpr std::size_t kFirstChunk = 8;
  for (std::size_t at = kFirstChunk; at + 8 <= bytes.size();) {
    if (bytes.compare(at + 4, 4, "IEND") == 0) {
      return {bigEndian(bytes, 16, 4), bigEndian(bytes, 20, 4), kPngPixelsPerByte};
    }
    at += std::size_t{12} + bigEndian(bytes, at, 4);
  }
  fail(name, "truncated PNG");
}

bool isFrameHeader(unsigned marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

/// Walks the segments to the end marker.
Claim jpegClaim(Bytes bytes, const std::string& name) {
  Claim claim{0, 0, kJpegPixelsPerByte};
  for (std::size_t at = bytes.find('\xff', 2); at != Bytes::npos; at = bytes.find('\xff', at)) {
    const unsigned marker = bigEndian(bytes, ++at, 1);
    if (marker == 0xD9) return claim;
    if (marker == 0xFF) continue;
    if (marker == 0 || marker == 1 || (marker >= 0xD0 && marker <= 0xD8)) continue;  // nothing follows these
    if (isFrameHeader(marker)) claim.widen(bigEndian(bytes, at + 6, 2), bigEndian(bytes, at + 4, 2));
    at += std::size_t{1} + std::max(2U, bigEndian(bytes, at + 1, 2));
  }
  fail(name, "truncated JPEG: it has no end marker");
}

Claim tiffClaim(Bytes bytes, const std::string&) {
  const auto number = bytes[0] == 'I' ? littleEndian : bigEndian;
  const std::size_t directory = number(bytes, 4, 4);
  const std::size_t entries = number(bytes, directory, 2);
  Claim claim;
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    const std::uint32_t tag = number(bytes, entry, 2);
    const std::size_t value_bytes = number(bytes, entry + 2, 2) == 3 ? 2 : 4;  // type 3 = 16 bit
    const std::uint32_t value = number(bytes, entry + 8, value_bytes);
    if (tag == 256) claim.widen(value, 0);
    if (tag == 257) claim.widen(0, value);
  }
  return claim;
}

Claim bmpClaim(Bytes bytes, const std::string&) {
  if (littleEndian(bytes, 14, 4) == 12) {
    return {littleEndian(bytes, 18, 2), littleEndian(bytes, 20, 2), kBmpPixelsPerByte};
  }
  const auto height = static_cast<std::int32_t>(littleEndian(bytes, 22, 4));  // negative: rows from the top down
  return {static_cast<std::int32_t>(littleEndian(bytes, 18, 4)), std::abs(static_cast<std::int64_t>(height)),
          kBmpPixelsPerByte};
}

Claim webpClaim(Bytes bytes, const std::string&) {
  const Bytes kind = bytes.substr(std::min<std::size_t>(12, bytes.size()), 4);
  if (kind == "VP8X") return {littleEndian(bytes, 24, 3) + 1, littleEndian(bytes, 27, 3) + 1};
  if (kind == "VP8L") {
    const std::uint32_t bits = littleEndian(bytes, 21, 4);
    return {(bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1};
  }
  return {littleEndian(bytes, 26, 2) & 0x3FFF, littleEndian(bytes, 28, 2) & 0x3FFF};
}

/// Width and height in digits, after white space and comments.
Claim pnmClaim(Bytes bytes, const std::string&) {
  std::array<std::int64_t, 2> sides{};
  std::size_t at = 2;
  for (std::int64_t& side : sides) {
    while (at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])) == 0) {
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    }
    for (; at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])) != 0; ++at) {
      side = std::min<std::int64_t>(10 * side + (bytes[at] - '0'), 1LL << 40);
    }
  }
  return {sides[0], sides[1], kPnmPixelsPerByte};
}

using ClaimOf = Claim (*)(Bytes bytes, const std::string& name);

/// What reads the header of such a file; null for any other format.
ClaimOf findFormat(Bytes bytes) {
  using namespace std::string_view_literals;
  static constexpr std::array<std::pair<Bytes, ClaimOf>, 6> kFormats = {{{"\x89PNG\r\n\x1a\n"sv, pngClaim},
                                                                         {"\xff\xd8\xff"sv, jpegClaim},
                                                                         {"II*\0"sv, tiffClaim},
                                                                         {"MM\0*"sv, tiffClaim},
                                                                         {"BM"sv, bmpClaim},
                                                                         {"RIFF"sv, webpClaim}}};
  for (const auto& [magic, claim] : kFormats) {
    if (bytes.compare(0, magic.size(), magic) == 0) return claim;
  }
  return bytes.size() >= 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6' ? pnmClaim : nullptr;
}

}  // namespace

void checkImageFormat(Bytes bytes, const std::string& name) {
  if (findFormat(bytes) != nullptr) return;
  fail(name, "not readable as an image: not PNG, JPEG, TIFF, BMP, WebP or PNM");
}

cv::Size claimedImageSize(Bytes bytes, const std::string& name) {
  checkImageFormat(bytes, name);
  const Claim claim = findFormat(bytes)(bytes, name);
  checkSides(name, claim.width, claim.height);
  const auto pixels = static_cast<std::uint64_t>(claim.width * claim.height);
  if (claim.pixels_per_byte > 0 && pixels > bytes.size() * claim.pixels_per_byte) {
    fail(name, "claims " + sizeText(claim.width, claim.height) + " px, more than its " + std::to_string(bytes.size()) +
                   " bytes can hold");
  }
  return {static_cast<int>(claim.width), static_cast<int>(claim.height)};
}

}  // namespace fdp_stereo
