// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace fdp_stereo::fuzz {

/// Takes values off the front of the fuzzer's bytes; zeros when they run out.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  template <typename T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof(T), size_);
    if (count > 0) std::memcpy(&value, data_, count);
    skip(count);
    return value;
  }
  /// Mostly small, now and then anything.
  std::uint32_t takeSize() {
    const auto kind = take<std::uint8_t>();
    return kind < 240 ? kind % 40U : take<std::uint32_t>();
  }
  std::string takeText(std::size_t longest) {
    const std::size_t count = std::min({static_cast<std::size_t>(take<std::uint8_t>()), longest, size_});
    const std::string text(reinterpret_cast<const char*>(data_), count);
    skip(count);
    return text;
  }
  std::vector<std::uint8_t> takeBytes(std::size_t count) {
    count = std::min(count, size_);
    std::vector<std::uint8_t> bytes(data_, data_ + count);
    skip(count);
    return bytes;
  }
  std::size_t left() const { return size_; }

 private:
  void skip(std::size_t count) {
    data_ += count;
    size_ -= count;
  }
  const std::uint8_t* data_;
  std::size_t size_;
};

}  // namespace fdp_stereo::fuzz
