// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <opencv2/core.hpp>
#include <string>

namespace fdp_stereo {

constexpr char kOutOfMemory[] =
    "out of memory; search fewer disparities, use smaller images (scale), or give the program more";

/// What the exception that is being handled says, in plain words where memory ran out; needs none itself. Valid as long
/// as the exception.
inline const char* describeCurrentException() {
  if (!std::current_exception()) return "without an exception";
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  } catch (const cv::Exception& error) {
    return error.code == cv::Error::StsNoMem ? kOutOfMemory : error.what();
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "an unknown exception";
  }
}

/// What libraries throw out of their own threads, and out of functions that must not throw, when memory runs out,
/// nobody can catch: from now on such an exception ends the process with 1 and a line on stderr, not with a signal.
inline void terminateWithMessage(const std::string& program) {
  static std::string name;
  name = program;
  std::set_terminate([] {
    std::fprintf(stderr, "%s: ended: %s\n", name.c_str(), describeCurrentException());
    std::_Exit(EXIT_FAILURE);
  });
}

}  // namespace fdp_stereo
