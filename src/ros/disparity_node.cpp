// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The nodelet fdp_stereo/disparity as a plain node.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include <nodelet/loader.h>
#include <ros/ros.h>

namespace {

/// What roscpp's own threads throw, when memory runs out, nobody can catch: an end with a message, not with a signal.
[[noreturn]] void endWithMessage() {
  try {
    std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    std::fputs("disparity: out of memory; lower disparity_range or scale, or raise the limit (ulimit -v)\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "disparity: ended: %s\n", error.what());
  } catch (...) {
    std::fputs("disparity: ended by an unknown exception\n", stderr);
  }
  std::_Exit(EXIT_FAILURE);
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(endWithMessage);
  ros::init(argc, argv, "disparity");
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), "fdp_stereo/disparity", ros::names::getRemappings(), {})) {
    std::fputs("disparity: the node cannot be started; where nothing else is said above, memory or threads ran out\n",
               stderr);
    return EXIT_FAILURE;
  }
  ros::spin();
  return 0;
}
