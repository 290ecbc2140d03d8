// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/robustness.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>
#include <utility>

#include "evaluation/corruption.hpp"
#include "evaluation/peer.hpp"

namespace fdp_stereo {
namespace {

bool isMeasure(const ResultRow& mean) { return mean.method == peerName(Peer::kSgbmHh); }

bool isCorrupted(const ResultRow& row) { return corruptionOf(row.scene) != "none"; }

std::vector<std::string> otherMethods(const std::vector<ResultRow>& means) {
  std::vector<std::string> names;
  for (const ResultRow& mean : means) {
    const bool known = std::find(names.begin(), names.end(), mean.method) != names.end();
    if (!known && !isMeasure(mean)) names.push_back(mean.method);
  }
  return names;
}

}  // namespace

Robustness robustnessOf(const std::vector<ResultRow>& rows) {
  if (std::none_of(rows.begin(), rows.end(), isCorrupted)) return {};
  const std::vector<ResultRow> means = averageRows(rows);
  std::map<std::pair<std::string, std::string>, double> bad_1;  // by scenes and method
  for (const ResultRow& mean : means) bad_1[{mean.scene, mean.method}] = mean.errors.bad[3];
  Robustness result{otherMethods(means), {}};
  for (const ResultRow& mean : means) {
    if (!isMeasure(mean)) continue;
    Robustness::Kind kind{corruptionOf(mean.scene), {}};
    for (const std::string& method : result.methods) {
      const auto own = bad_1.find({mean.scene, method});
      kind.ratios.push_back(own == bad_1.end() ? kUnknown : own->second / mean.errors.bad[3]);
    }
    result.kinds.push_back(kind);
  }
  return result;
}

std::string tableText(const Robustness& robustness) {
  if (robustness.kinds.empty()) return "";
  std::ostringstream out;
  out << "bad 1 / that of " << peerName(Peer::kSgbmHh) << '\n' << std::left << std::setw(14) << "images" << std::right;
  for (const std::string& method : robustness.methods) out << std::setw(static_cast<int>(method.size()) + 6) << method;
  out << std::fixed << std::setprecision(2) << '\n';
  for (const Robustness::Kind& kind : robustness.kinds) {
    out << std::left << std::setw(14) << kind.corruption << std::right;
    for (std::size_t m = 0; m < kind.ratios.size(); ++m) {
      out << std::setw(static_cast<int>(robustness.methods[m].size()) + 6);
      std::isfinite(kind.ratios[m]) ? out << kind.ratios[m] : out << "-";
    }
    out << '\n';
  }
  return out.str();
}

}  // namespace fdp_stereo
