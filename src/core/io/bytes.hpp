// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <istream>
#include <string>
#include <string_view>

namespace fdp_stereo {

/// Throws std::runtime_error "name: problem".
[[noreturn]] void fail(const std::string& name, const std::string& problem);

/// Extension of a path in lower case with its dot, "" for none.
std::string extension(const std::string& path);

/// Opens a file that can be read and is not empty; throws naming it.
std::ifstream openFile(const std::string& path);
/// Appends what follows in a stream, at most `most` bytes; takes memory as the bytes come, so that pipes do too.
void appendBytes(std::istream& stream, std::size_t most, std::string& bytes);

std::string sizeText(std::int64_t width, std::int64_t height);
/// Throws unless both sides are 1 to kMaxImageSide.
void checkSides(const std::string& name, std::int64_t width, std::int64_t height);

/// An unsigned integer of `count` bytes at `at`; 0 beyond the end.
std::uint32_t bigEndian(std::string_view bytes, std::size_t at, std::size_t count);
std::uint32_t littleEndian(std::string_view bytes, std::size_t at, std::size_t count);

}  // namespace fdp_stereo
