// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "output_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <climits>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

void require(bool holds, const std::string& path, const std::string& problem) {
  if (!holds) throw std::runtime_error(path + ": " + problem);
}

bool same(const std::string& a, const std::string& b) {
  std::error_code none;
  return fs::equivalent(a, b, none) || fs::weakly_canonical(a, none) == fs::weakly_canonical(b, none);
}

void checkOutput(const std::string& path, const std::vector<std::string>& inputs, bool overwrite) {
  std::error_code none;
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  require(fs::is_directory(folder, none), path, "cannot be written: there is no folder " + folder.string());
  require(!fs::is_directory(path, none), path, "cannot be written: it is a folder");
  if (fs::exists(path, none)) {
    require(access(path.c_str(), W_OK) == 0, path, "cannot be written: no permission");
    if (!fs::is_regular_file(path, none)) return;  // a pipe or a device
    const bool is_input =
        std::any_of(inputs.begin(), inputs.end(), [&](const auto& input) { return same(path, input); });
    require(!is_input, path, "is an input, which is never overwritten; give another name");
    require(overwrite, path, "exists already, give another name or --overwrite");
  }
  require(access(folder.c_str(), W_OK) == 0, path, "cannot be written: no permission in its folder");
}

// The name of the file to remove, where a signal handler can read it.
char partial_name[PATH_MAX] = "";

void removeAndEnd(int signal) {
  if (partial_name[0] != '\0') unlink(partial_name);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void watchFor(const std::string& name) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, name.empty() ? SIG_DFL : removeAndEnd);
  partial_name[std::min(name.size(), sizeof partial_name - 1)] = '\0';
  std::copy_n(name.begin(), std::min(name.size(), sizeof partial_name - 1), partial_name);
}

}  // namespace

void checkOutputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, bool overwrite) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    checkOutput(outputs[i], inputs, overwrite);
    for (std::size_t j = 0; j < i; ++j) {
      const bool device = fs::exists(outputs[i]) && !fs::is_regular_file(outputs[i]);
      require(outputs[j].empty() || device || !same(outputs[i], outputs[j]), outputs[i], "is given for two outputs");
    }
  }
}

PartialFile::PartialFile(std::string path) : path_(std::move(path)), partial_(path_ + ".partial") {
  watchFor(partial_);
}

PartialFile::~PartialFile() {
  if (partial_.empty()) return;
  std::error_code none;
  fs::remove(partial_, none);
  watchFor("");
}

void PartialFile::finish() {
  std::error_code problem;
  fs::rename(partial_, path_, problem);
  require(!problem, path_, "cannot be written: " + problem.message());
  partial_.clear();
  watchFor("");
}

}  // namespace fdp_stereo
