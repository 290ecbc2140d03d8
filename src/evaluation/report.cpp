// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/report.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "evaluation/pictures.hpp"
#include "evaluation/report_template.hpp"
#include "evaluation/runner.hpp"
#include "json_writer.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

void addRows(JsonWriter& json, const std::string& key, const std::vector<ResultRow>& rows) {
  json.open('[', key);
  for (const ResultRow& row : rows) {
    json.open('{').add("scene", row.scene).add("method", row.method).open('[', "values");
    for (const Column& column : resultColumns()) json.add("", column.get(row));
    json.close(']').close('}');
  }
  json.close(']');
}

void addPicture(JsonWriter& json, const std::string& folder, const std::string& file, const std::string& caption) {
  if (fs::exists(fs::path(folder) / file)) json.open('{').add("file", file).add("caption", caption).close('}');
}

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// Per scene one line of pictures of the input, then one per method.
void addPictures(JsonWriter& json, const std::string& folder, const std::vector<ResultRow>& rows) {
  json.open('[', "pictures");
  std::vector<std::string> scenes;
  for (const ResultRow& row : rows) {
    if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end()) scenes.push_back(row.scene);
  }
  for (const std::string& scene : scenes) {
    json.open('{').add("scene", scene).open('[', "rows").open('[');
    addPicture(json, folder, pictureName(scene, "", "left"), "left image");
    addPicture(json, folder, pictureName(scene, "", "truth"), "truth");
    json.close(']');
    for (const ResultRow& row : rows) {
      if (row.scene != scene) continue;
      json.open('[');
      const auto add = [&](const char* kind, const std::string& caption) {
        addPicture(json, folder, pictureName(scene, row.method, kind), row.method + ": " + caption);
      };
      add("disparity", "disparity");
      add("errors", "errors, bad 1 " + fixed(row.errors.bad[3], 2) + " %");
      add("invalid", "without disparity (magenta)");
      add("seeds", "seeds");
      json.close(']');
    }
    json.close(']').close('}');
  }
  json.close(']');
}

std::string reportJson(const std::string& folder, const std::vector<ResultRow>& rows, const ReportOrigin& origin) {
  JsonWriter json;
  json.open('{').add("conditions", origin.conditions).add("command", origin.command).open('[', "columns");
  for (const Column& column : resultColumns()) {
    json.open('{').add("name", column.name).add("heading", column.heading);
    json.add("better", column.better == Better::kSmaller  ? "smaller"
                       : column.better == Better::kLarger ? "larger"
                                                          : "");
    json.close('}');
  }
  json.close(']');
  addRows(json, "rows", rows);
  addRows(json, "means", averageRows(rows));
  addPictures(json, folder, rows);
  return json.close('}').text();
}

/// i and n of "results-i-of-n.csv"; false for any other name.
bool parseShardName(const std::string& name, int& index, int& count) {
  return std::sscanf(name.c_str(), "results-%d-of-%d.csv", &index, &count) == 2 && name == shardTableName(index, count);
}

}  // namespace

void writeReport(const std::string& folder, const std::vector<ResultRow>& rows, const ReportOrigin& origin) {
  std::string page = kReportTemplate;
  const std::string mark = "/*REPORT*/";
  page.replace(page.find(mark), mark.size(), reportJson(folder, rows, origin));
  const std::string path = (fs::path(folder) / "index.html").string();
  std::ofstream file(path);
  file << page;
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

std::vector<ResultRow> mergeShards(const std::string& folder) {
  if (!fs::is_directory(folder)) throw std::runtime_error(folder + ": no such folder");
  int count = 1;
  for (const auto& entry : fs::directory_iterator(folder)) {
    int index = 0;
    int shards = 0;
    if (parseShardName(entry.path().filename().string(), index, shards)) count = std::max(count, shards);
  }
  std::vector<ResultRow> rows;
  for (int index = 1; index <= count; ++index) {
    const std::vector<ResultRow> part = readCsv((fs::path(folder) / shardTableName(index, count)).string());
    rows.insert(rows.end(), part.begin(), part.end());
  }
  std::stable_sort(rows.begin(), rows.end(), [](const ResultRow& a, const ResultRow& b) { return a.scene < b.scene; });
  return rows;
}

}  // namespace fdp_stereo
