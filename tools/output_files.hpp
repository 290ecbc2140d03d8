// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fdp_stereo {

/// Checks before the work begins that every output ("" = not wanted) can be written: its folder is there, it is no
/// input, and it does not exist unless `overwrite`. Throws std::runtime_error naming the file and the remedy.
void checkOutputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, bool overwrite);

/// A file that takes long to write: called PATH.partial until it is finished, removed where the program ends before,
/// by Ctrl-C too. One at a time.
class PartialFile {
 public:
  explicit PartialFile(std::string path);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::string& partial() const { return partial_; }
  void finish();

 private:
  std::string path_;
  std::string partial_;
};

}  // namespace fdp_stereo
