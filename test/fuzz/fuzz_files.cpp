// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Files a user may give: PFM, PNG and text seeds. The readers throw std::runtime_error or return a map.
#include <stdlib.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "fdp_stereo/io.hpp"
#include "fuzz_input.hpp"

namespace fdp_stereo::fuzz {
namespace {

/// A folder of this process, in memory where the system has such.
const std::string& folder() {
  static const std::string path = [] {
    std::string name =
        access("/dev/shm", W_OK) == 0 ? "/dev/shm/fdp_stereo_fuzz_XXXXXX" : "/tmp/fdp_stereo_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) abort();
    return name;
  }();
  return path;
}

std::string writeFile(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  const std::string path = folder() + "/" + name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

template <typename Call>
void expectOnlyRuntimeError(Call&& call) {
  try {
    call();
  } catch (const std::runtime_error&) {
  }
}

}  // namespace
}  // namespace fdp_stereo::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fdp_stereo;
  fuzz::Input input(data, size);
  const auto kind = input.take<std::uint8_t>() % 4;
  const char* const names[] = {"map.pfm", "map.png", "seeds.txt", "image.png"};
  const std::string path = fuzz::writeFile(names[kind], input.takeBytes(1U << 16));
  fuzz::expectOnlyRuntimeError([&] {
    if (kind <= 1) readDisparity(path);
    if (kind == 2) readSeeds(path);
    if (kind == 3) readImage(path);
  });
  return 0;
}
