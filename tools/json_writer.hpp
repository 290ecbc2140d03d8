// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <locale>
#include <sstream>
#include <string>

namespace fdp_stereo {

/// Writes JSON members one after another; the caller opens and closes objects and arrays in order.
class JsonWriter {
 public:
  JsonWriter() {
    out_.imbue(std::locale::classic());
    out_.precision(10);
  }

  JsonWriter& open(char bracket, const std::string& key = "") {
    separate(key);
    out_ << bracket;
    first_ = true;
    return *this;
  }
  JsonWriter& close(char bracket) {
    out_ << bracket;
    first_ = false;
    return *this;
  }
  JsonWriter& add(const std::string& key, const std::string& text) {
    separate(key);
    out_ << quote(text);
    return *this;
  }
  JsonWriter& add(const std::string& key, const char* text) { return add(key, std::string(text)); }
  JsonWriter& add(const std::string& key, bool value) {
    separate(key);
    out_ << (value ? "true" : "false");
    return *this;
  }
  JsonWriter& add(const std::string& key, int value) { return add(key, static_cast<double>(value)); }
  /// A number that is not finite becomes null.
  JsonWriter& add(const std::string& key, double value) {
    separate(key);
    std::isfinite(value) ? out_ << value : out_ << "null";
    return *this;
  }
  std::string text() const { return out_.str() + "\n"; }

 private:
  void separate(const std::string& key) {
    if (!first_) out_ << ", ";
    first_ = false;
    if (!key.empty()) out_ << quote(key) << ": ";
  }
  static std::string quote(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') {
        quoted += std::string("\\") + c;
      } else if (static_cast<unsigned char>(c) < 0x20 || c == '<') {  // '<': safe inside a page's script
        char escaped[8];
        std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
        quoted += escaped;
      } else {
        quoted += c;
      }
    }
    return quoted + "\"";
  }

  std::ostringstream out_;
  bool first_ = true;
};

}  // namespace fdp_stereo
