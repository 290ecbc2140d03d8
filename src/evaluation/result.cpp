// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/result.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "evaluation/corruption.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

template <std::size_t kIndex>
Column badColumn(const char* name, const char* heading) {
  return {name, heading, Better::kSmaller, [](const ResultRow& row) { return row.errors.bad[kIndex]; },
          [](ResultRow& row, double value) { row.errors.bad[kIndex] = value; }};
}

#define FDP_STEREO_COLUMN(name, heading, better, member)                    \
  Column {                                                                  \
    name, heading, better, [](const ResultRow& row) { return row.member; }, \
        [](ResultRow& row, double value) { row.member = value; }            \
  }

std::string number(double value) {
  if (!std::isfinite(value)) return "";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(10) << value;
  return text.str();
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::vector<std::string> splitCsv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && inside && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (line[i] == '"') {
      inside = !inside;
    } else if (line[i] == ',' && !inside) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

ResultRow parseRow(const std::string& line) {
  const std::vector<Column>& columns = resultColumns();
  const std::vector<std::string> fields = splitCsv(line);
  if (fields.size() != columns.size() + 3) throw std::invalid_argument("number of fields");
  ResultRow row;
  row.scene = fields[0];
  row.method = fields[1];
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& text = fields[i + 2];
    columns[i].set(row, text.empty() ? kUnknown : std::stod(text));
  }
  row.settings = fields.back();
  return row;
}

/// The part of the settings that is the method's.
std::string methodSettings(const ResultRow& row) { return row.settings.substr(0, row.settings.find('-')); }

template <typename Key>
std::vector<ResultRow> newestOf(const std::vector<ResultRow>& rows, Key&& key) {
  std::vector<ResultRow> newest;
  std::map<std::string, std::size_t> places;
  for (const ResultRow& row : rows) {
    const auto [place, is_new] = places.emplace(key(row), newest.size());
    if (is_new) {
      newest.push_back(row);
    } else {
      newest[place->second] = row;
    }
  }
  return newest;
}

ResultRow averageOf(const std::vector<const ResultRow*>& rows) {
  ResultRow mean = *rows.front();
  const std::string kind = corruptionOf(mean.scene);
  mean.scene = "mean of " + std::to_string(rows.size()) + (kind == "none" ? "" : "+" + kind);
  double total = 0.0;
  for (const ResultRow* row : rows) total += middleburyWeight(row->scene);
  for (const Column& column : resultColumns()) {
    double sum = 0.0;
    for (const ResultRow* row : rows) sum += middleburyWeight(row->scene) * column.get(*row);
    column.set(mean, sum / total);
  }
  return mean;
}

void printRow(std::ostringstream& out, const ResultRow& row, std::size_t scene_width, std::size_t method_width) {
  out << std::left << std::setw(static_cast<int>(scene_width)) << row.scene << std::setw(static_cast<int>(method_width))
      << row.method << std::right << std::fixed << std::setprecision(2);
  for (const Column& column : resultColumns()) {
    const double value = column.get(row);
    out << std::setw(10);
    std::isfinite(value) ? out << value : out << "-";
  }
  out << '\n';
}

}  // namespace

const std::vector<Column>& resultColumns() {
  static const std::vector<Column> columns = {
      badColumn<0>("bad_0.125", "bad .125"),
      badColumn<1>("bad_0.25", "bad .25"),
      badColumn<2>("bad_0.5", "bad .5"),
      badColumn<3>("bad_1", "bad 1"),
      badColumn<4>("bad_2", "bad 2"),
      badColumn<5>("bad_3", "bad 3"),
      FDP_STEREO_COLUMN("d1", "D1", Better::kSmaller, errors.d1),
      FDP_STEREO_COLUMN("density", "density", Better::kLarger, errors.density),
      FDP_STEREO_COLUMN("sparse_bad_0.5", "sparse .5", Better::kSmaller, errors.sparse_bad_half),
      FDP_STEREO_COLUMN("average_px", "avg px", Better::kSmaller, errors.average_px),
      FDP_STEREO_COLUMN("a95_px", "A95 px", Better::kSmaller, errors.a95_px),
      FDP_STEREO_COLUMN("time_ms", "ms", Better::kSmaller, time_ms),
      FDP_STEREO_COLUMN("cpu_ms", "CPU ms", Better::kSmaller, cpu_ms),
      FDP_STEREO_COLUMN("memory_mb", "MB", Better::kSmaller, memory_mb),
      FDP_STEREO_COLUMN("seeds", "seeds", Better::kNeither, seeds),
      FDP_STEREO_COLUMN("seeds_wrong", "wrong %", Better::kSmaller, seeds_wrong),
      FDP_STEREO_COLUMN("quasi_dense", "dense", Better::kNeither, dense),
      FDP_STEREO_COLUMN("quasi_dense_wrong", "wrong %", Better::kSmaller, dense_wrong),
      FDP_STEREO_COLUMN("rows_before_px", "rows px", Better::kNeither, rows_before_px),
      FDP_STEREO_COLUMN("rows_after_px", "after px", Better::kNeither, rows_after_px),
  };
  return columns;
}

std::vector<ResultRow> readCsv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::vector<ResultRow> rows;
  std::string line;
  for (int count = 1; std::getline(file, line) && !file.eof(); ++count) {
    if (count == 1 && line != csvHeader()) throw std::runtime_error(path + ":1: is no table of this version");
    if (count == 1 || line.empty()) continue;
    try {
      rows.push_back(parseRow(line));
    } catch (const std::logic_error&) {
      throw std::runtime_error(path + ":" + std::to_string(count) + ": is no row of a table; delete the line");
    }
  }
  return rows;
}

std::string csvHeader() {
  std::string header = "scene,method";
  for (const Column& column : resultColumns()) header += std::string(",") + column.name;
  return header + ",settings";
}

std::string csvLine(const ResultRow& row) {
  std::string line = quoted(row.scene) + "," + quoted(row.method);
  for (const Column& column : resultColumns()) line += "," + number(column.get(row));
  return line + "," + row.settings;
}

void writeCsv(const std::string& path, const std::vector<ResultRow>& rows) {
  std::string text = csvHeader() + "\n";
  for (const ResultRow& row : rows) text += csvLine(row) + "\n";
  writeFile(path, text);
}

std::vector<ResultRow> uniqueRows(const std::vector<ResultRow>& rows) {
  return newestOf(rows, [](const ResultRow& row) { return row.scene + '\n' + row.method + '\n' + row.settings; });
}

std::vector<ResultRow> newestRows(const std::vector<ResultRow>& rows) {
  return newestOf(rows, [](const ResultRow& row) { return row.scene + '\n' + row.method; });
}

std::vector<ResultRow> rowsToShow(const std::vector<ResultRow>& rows) {
  std::map<std::string, std::string> newest;  // settings of a method
  std::map<std::string, std::size_t> scenes;  // in the order of their first rows
  for (const ResultRow& row : rows) {
    newest[row.method] = methodSettings(row);
    scenes.emplace(row.scene, scenes.size());
  }
  std::vector<ResultRow> shown = uniqueRows(rows);
  for (ResultRow& row : shown) {
    const std::string settings = methodSettings(row);
    if (settings != newest[row.method]) row.method += "~" + settings.substr(0, 4);
  }
  std::stable_sort(shown.begin(), shown.end(),
                   [&](const ResultRow& a, const ResultRow& b) { return scenes.at(a.scene) < scenes.at(b.scene); });
  return shown;
}

std::vector<ResultRow> averageRows(const std::vector<ResultRow>& rows) {
  std::vector<std::vector<const ResultRow*>> groups;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  for (const ResultRow& row : rows) {
    const auto [place, is_new] = places.emplace(std::pair(corruptionOf(row.scene), row.method), groups.size());
    if (is_new) groups.emplace_back();
    groups[place->second].push_back(&row);
  }
  std::vector<ResultRow> averages;
  for (const auto& group : groups) averages.push_back(averageOf(group));
  return averages;
}

std::string tableText(const std::vector<ResultRow>& rows) {
  const std::vector<ResultRow> averages = averageRows(rows);
  std::size_t scene_width = 14;
  std::size_t method_width = 11;
  for (const std::vector<ResultRow>* part : {&rows, &averages}) {
    for (const ResultRow& row : *part) {
      scene_width = std::max(scene_width, row.scene.size() + 2);
      method_width = std::max(method_width, row.method.size() + 2);
    }
  }
  std::ostringstream out;
  out << std::left << std::setw(static_cast<int>(scene_width)) << "scene" << std::setw(static_cast<int>(method_width))
      << "method" << std::right;
  for (const Column& column : resultColumns()) out << std::setw(10) << column.heading;
  out << '\n';
  for (const ResultRow& row : rows) printRow(out, row, scene_width, method_width);
  for (const ResultRow& row : averages) printRow(out, row, scene_width, method_width);
  return out.str();
}

std::string fingerprint(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : bytes) hash = (hash ^ static_cast<std::uint8_t>(c)) * 1099511628211ULL;
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(hash));
  return hex;
}

}  // namespace fdp_stereo
