// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>

namespace fdp_stereo {

/// Plain memory for large arrays of numbers: not initialised, aligned for vectors, in huge pages where the system has
/// them, so that a first frame touches every page once.
class Buffer {
 public:
  Buffer() = default;
  Buffer(const Buffer& other);
  Buffer& operator=(const Buffer& other);
  Buffer(Buffer&&) = default;
  Buffer& operator=(Buffer&&) = default;
  ~Buffer() = default;

  /// Makes room for at least so many bytes; contents are lost where that takes new memory, and the old goes first.
  /// Throws std::bad_alloc.
  void reserve(std::size_t bytes);
  std::size_t size() const { return size_; }

  template <typename T>
  T* as() {
    return reinterpret_cast<T*>(data_.get());
  }
  template <typename T>
  const T* as() const {
    return reinterpret_cast<const T*>(data_.get());
  }

 private:
  struct Free {
    void operator()(unsigned char* memory) const;
  };
  std::unique_ptr<unsigned char, Free> data_;
  std::size_t size_ = 0;
};

/// Tells the C library to keep what is freed for the next frame. Left to itself glibc gives it back to the system, and
/// every page of every frame costs a fault again: on a virtual machine half of the time of the preset light. Concerns
/// the whole process; the tools and the node do it when they start, a program that matches a stream should, too.
void keepFreedMemory();

}  // namespace fdp_stereo
