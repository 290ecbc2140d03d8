// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>

/// Texts for people: errors, log lines, diagnostics.
namespace fdp_stereo {

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

/// A text from a message as it may stand in a log line: in quotes, at most 40 characters, what is not printable as '?'.
inline std::string quoteForLog(const std::string& received) {
  constexpr std::size_t kLongest = 40;
  std::string safe = received.substr(0, kLongest);
  std::replace_if(
      safe.begin(), safe.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + safe + "'";
}

}  // namespace fdp_stereo
