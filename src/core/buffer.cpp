// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/buffer.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace fdp_stereo {
namespace {

constexpr std::size_t kVector = 64;
constexpr std::size_t kHugePage = std::size_t{1} << 21;

}  // namespace

void Buffer::Free::operator()(unsigned char* memory) const { std::free(memory); }

Buffer::Buffer(const Buffer& other) { *this = other; }

Buffer& Buffer::operator=(const Buffer& other) {
  if (this == &other) return *this;
  reserve(other.size_);
  std::copy_n(other.as<unsigned char>(), other.size_, as<unsigned char>());
  return *this;
}

void Buffer::reserve(std::size_t bytes) {
  if (bytes <= size_) return;
  data_.reset();
  size_ = 0;
  const std::size_t alignment = bytes >= 2 * kHugePage ? kHugePage : kVector;
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  data_.reset(static_cast<unsigned char*>(std::aligned_alloc(alignment, rounded)));
  if (!data_) throw std::bad_alloc();
  size_ = rounded;
#ifdef __linux__
  if (alignment == kHugePage) madvise(data_.get(), rounded, MADV_HUGEPAGE);  // a wish: ordinary pages do as well
#endif
}

void keepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kLargestOfHeap = 32 << 20;  // bytes, the most that glibc allows; larger ones are mapped
  constexpr int kKept = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kLargestOfHeap);
  mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

}  // namespace fdp_stereo
