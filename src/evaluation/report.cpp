// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/report.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "evaluation/corruption.hpp"
#include "evaluation/pictures.hpp"
#include "evaluation/report_template.hpp"
#include "evaluation/robustness.hpp"
#include "evaluation/runner.hpp"
#include "fdp_stereo/io.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::json;

constexpr char kTitle[] = "<title>fdp_stereo: evaluation</title>";

Json rowsJson(const std::vector<ResultRow>& rows) {
  Json list = Json::array();
  for (const ResultRow& row : rows) {
    Json values = Json::array();
    for (const Column& column : resultColumns()) values.push_back(column.get(row));
    list.push_back(
        {{"scene", row.scene}, {"images", corruptionOf(row.scene)}, {"method", row.method}, {"values", values}});
  }
  return list;
}

Json robustnessJson(const Robustness& robustness) {
  Json kinds = Json::array();
  for (const Robustness::Kind& kind : robustness.kinds) {
    kinds.push_back({{"images", kind.corruption}, {"ratios", kind.ratios}});
  }
  return {{"methods", robustness.methods}, {"kinds", kinds}};
}

/// What each kind of images is.
Json corruptionsJson() {
  Json texts = Json::object();
  for (const Corruption& corruption : corruptions()) texts[corruption.name] = corruption.strength;
  return texts;
}

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// One line of pictures: those of the files "kind: caption" that exist.
Json picturesJson(const std::string& folder, const std::string& scene, const std::string& method,
                  const std::vector<std::pair<std::string, std::string>>& kinds) {
  Json line = Json::array();
  for (const auto& [kind, caption] : kinds) {
    const std::string file = pictureName(scene, method, kind);
    if (!fs::exists(fs::path(folder) / file)) continue;
    line.push_back({{"file", file}, {"caption", method.empty() ? caption : method + ": " + caption}});
  }
  return line;
}

/// Per scene one line of pictures of the input, then one per method.
Json scenesJson(const std::string& folder, const std::vector<ResultRow>& rows) {
  std::vector<std::string> scenes;
  std::map<std::string, Json> lines;
  for (const ResultRow& row : rows) {
    Json& own = lines[row.scene];
    if (own.is_null()) {
      scenes.push_back(row.scene);
      own = Json::array({picturesJson(folder, row.scene, "", {{"left", "left image"}, {"truth", "truth"}})});
    }
    own.push_back(picturesJson(folder, row.scene, row.method,
                               {{"disparity", "disparity"},
                                {"errors", "errors, bad 1 " + fixed(row.errors.bad[3], 2) + " %"},
                                {"invalid", "without disparity (magenta)"},
                                {"seeds", "seeds"}}));
  }
  Json list = Json::array();
  for (const std::string& scene : scenes) list.push_back({{"scene", scene}, {"rows", lines[scene]}});
  return list;
}

std::string reportJson(const std::string& folder, const std::vector<ResultRow>& rows, const ReportOrigin& origin) {
  Json columns = Json::array();
  for (const Column& column : resultColumns()) {
    const char* better = column.better == Better::kSmaller  ? "smaller"
                         : column.better == Better::kLarger ? "larger"
                                                            : "";
    columns.push_back({{"name", column.name}, {"heading", column.heading}, {"better", better}});
  }
  const std::vector<ResultRow> shown = rowsToShow(rows);
  const Json page = {{"conditions", origin.conditions},
                     {"command", origin.command},
                     {"columns", columns},
                     {"rows", rowsJson(shown)},
                     {"means", rowsJson(averageRows(shown))},
                     {"corruptions", corruptionsJson()},
                     {"robustness", robustnessJson(robustnessOf(shown))},
                     {"pictures", scenesJson(folder, newestRows(rows))}};
  std::string text = page.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");  // safe inside a page's script
  }
  return text;
}

/// i and n of "results-i-of-n.csv"; false for any other name.
bool parseShardName(const std::string& name, int& index, int& count) {
  return std::sscanf(name.c_str(), "results-%d-of-%d.csv", &index, &count) == 2 && name == shardTableName(index, count);
}

std::string reportPath(const std::string& folder) { return (fs::path(folder) / "index.html").string(); }

}  // namespace

void writeReport(const std::string& folder, const std::vector<ResultRow>& rows, const ReportOrigin& origin) {
  std::string page = kReportTemplate;
  const std::string mark = "/*REPORT*/";
  page.replace(page.find(mark), mark.size(), reportJson(folder, rows, origin));
  writeFile(reportPath(folder), page);
}

void checkReport(const std::string& folder) {
  std::ifstream file(reportPath(folder));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.empty() || text.find(kTitle) != std::string::npos) return;
  throw std::runtime_error(reportPath(folder) + ": exists and is no page of evaluate; give another folder");
}

std::vector<ResultRow> mergeShards(const std::string& folder) {
  if (!fs::is_directory(folder)) throw std::runtime_error(folder + ": no such folder");
  std::set<int> counts;
  for (const auto& entry : fs::directory_iterator(folder)) {
    int index = 0;
    int shards = 0;
    if (parseShardName(entry.path().filename().string(), index, shards)) counts.insert(shards);
  }
  if (counts.empty() || fs::exists(fs::path(folder) / shardTableName(1, 1))) counts.insert(1);
  std::vector<ResultRow> rows;
  for (const int count : counts) {
    for (int index = 1; index <= count; ++index) {
      const std::vector<ResultRow> part = readCsv((fs::path(folder) / shardTableName(index, count)).string());
      rows.insert(rows.end(), part.begin(), part.end());
    }
  }
  rows = uniqueRows(rows);
  std::stable_sort(rows.begin(), rows.end(), [](const ResultRow& a, const ResultRow& b) { return a.scene < b.scene; });
  return rows;
}

}  // namespace fdp_stereo
