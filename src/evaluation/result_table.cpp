// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/result_table.hpp"

#include <filesystem>
#include <iostream>
#include <iterator>
#include <stdexcept>

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

/// Bytes of the lines that are whole; of a header that was cut, none.
std::size_t wholeBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t end = text.rfind('\n');
  if (end != std::string::npos) return end + 1;
  if (csvHeader().compare(0, text.size(), text) == 0) return 0;
  throw std::runtime_error(path + ": is no table of this version; give another folder");
}

}  // namespace

ResultTable::ResultTable(const std::string& path) : path_(path) {
  const std::size_t bytes = fs::exists(path) ? fs::file_size(path) : 0;
  const std::size_t whole = bytes > 0 ? wholeBytes(path) : 0;
  if (whole > 0) earlier_ = readCsv(path);
  if (whole < bytes) {
    std::cerr << path << ": the last line was cut; its scene is run again\n";
    fs::resize_file(path, whole);
  }
  file_.open(path, std::ios::app);
  if (whole == 0) file_ << csvHeader() << std::endl;
  if (!file_) throw std::runtime_error(path + ": cannot be written");
}

const ResultRow* ResultTable::find(const std::string& scene, const std::string& method,
                                   const std::string& settings) const {
  for (auto row = earlier_.rbegin(); row != earlier_.rend(); ++row) {
    if (row->scene == scene && row->method == method && row->settings == settings) return &*row;
  }
  return nullptr;
}

void ResultTable::add(const ResultRow& row) {
  const std::lock_guard<std::mutex> lock(mutex_);
  file_ << csvLine(row) + "\n" << std::flush;
  if (!file_) throw std::runtime_error(path_ + ": cannot be written");
}

}  // namespace fdp_stereo
