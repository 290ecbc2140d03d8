// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "node_status.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "stamps.hpp"

namespace fdp_stereo {
namespace {

using diagnostic_msgs::DiagnosticStatus;

std::string counts(const NodeStatus& now, const NodeStatus& before) {
  std::ostringstream text;
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    text << (i == 0 ? "" : ", ") << now.inputs[i].topic << " "
         << now.inputs[i].count.received - before.inputs[i].count.received;
  }
  return text.str();
}

/// Topics that brought nothing since `before`.
std::string missingTopics(const NodeStatus& now, const NodeStatus& before) {
  std::string text;
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    const InputStatus& input = now.inputs[i];
    if (input.count.received != before.inputs[i].count.received) continue;
    text += (text.empty() ? "" : "; ") + input.topic +
            (input.publishers == 0 ? " has no publisher (check the name with rostopic list)"
                                   : " has a publisher that sends nothing (check with rostopic hz)");
  }
  return text;
}

/// All topics arrive, so their stamps do not meet.
std::string stampCause(const NodeStatus& status) {
  const auto earlier = [](const InputStatus& a, const InputStatus& b) { return a.count.stamp < b.count.stamp; };
  const auto first = std::min_element(status.inputs.begin(), status.inputs.end(), earlier);
  const auto last = std::max_element(status.inputs.begin(), status.inputs.end(), earlier);
  std::ostringstream text;
  text.precision(4);
  text << "the newest stamps of " << first->topic << " and " << last->topic << " are apart by "
       << secondsBetween(first->count.stamp, last->count.stamp) * 1e3 << " ms; ";
  if (status.approximate_sync) {
    text << "raise ~queue_size or ~approximate_sync_tolerance, or synchronise the cameras";
  } else {
    text << "the cameras must be triggered together and camera_info carry the image's stamp, or set ~approximate_sync";
  }
  return text.str();
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += (text.empty() ? "" : "; ") + line;
  return text;
}

/// Of stamps from another clock, as in a recording that is played without --clock, no age is known.
std::string age(double age_ms) {
  constexpr double kHour = 3.6e6;
  if (std::abs(age_ms) > kHour) return "unknown: the stamps are of another clock (a bag played without --clock?)";
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << age_ms;
  return text.str();
}

double rate(std::uint64_t now, std::uint64_t before, double seconds) {
  return seconds > 0.0 ? static_cast<double>(now - before) / seconds : 0.0;
}

void summarize(const NodeStatus& status, diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  if (status.master_lost) {
    diagnostics.summary(DiagnosticStatus::ERROR, "The ROS master does not answer");
  } else if (!status.subscribed) {
    diagnostics.summary(DiagnosticStatus::OK, "Idle: no output has a subscriber");
  } else if (status.error_is_current) {
    diagnostics.summary(DiagnosticStatus::ERROR, status.last_error);
  } else if (status.pairs == 0) {
    diagnostics.summary(DiagnosticStatus::WARN, "No synchronised pair yet");
  } else if (!status.frame.warnings.empty()) {
    diagnostics.summary(DiagnosticStatus::WARN, joined(status.frame.warnings));
  } else {
    diagnostics.summary(DiagnosticStatus::OK, "Running");
  }
}

}  // namespace

std::string describeSilence(const NodeStatus& now, const NodeStatus& before, double seconds) {
  if (!now.subscribed || !before.subscribed || now.processed != before.processed) return "";
  std::ostringstream text;
  if (now.pairs != before.pairs) {
    if (now.failed == before.failed) return "";
    text << now.pairs - before.pairs << " pairs in the last " << std::lround(seconds)
         << " s, none could be used: " << now.last_error;
    return text.str();
  }
  const std::string missing = missingTopics(now, before);
  text << "no synchronised pair in the last " << std::lround(seconds) << " s. Messages: " << counts(now, before)
       << ". Likely cause: " << (missing.empty() ? stampCause(now) : missing);
  return text.str();
}

void describeStatus(const NodeStatus& now, const NodeStatus& before, double seconds,
                    diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  summarize(now, diagnostics);
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    const InputStatus& input = now.inputs[i];
    diagnostics.addf(input.topic, "%llu received, %.1f Hz", static_cast<unsigned long long>(input.count.received),
                     rate(input.count.received, before.inputs[i].count.received, seconds));
  }
  diagnostics.add("Pairs synchronised", now.pairs);
  diagnostics.add("Pairs processed", now.processed);
  diagnostics.addf("Output rate (Hz)", "%.2f", rate(now.processed, before.processed, seconds));
  diagnostics.add("Pairs failed", now.failed);
  diagnostics.add("Pairs dropped (overload)", now.dropped);
  diagnostics.add("Pairs dropped (max_rate)", now.over_rate);
  diagnostics.add("Pairs dropped (max_age)", now.too_old);
  diagnostics.add("Pairs waiting", now.waiting);
  diagnostics.addf("Processing (ms)", "%.1f", now.processing_ms);
  diagnostics.addf("Scale of the images matched", "%.2f", now.frame.scale);
  diagnostics.addf("Latency (ms)", "%.1f", now.latency_ms);
  diagnostics.add("Age of the output (ms)", age(now.age_ms));
  diagnostics.addf("Stamps of left and right apart (ms)", "%.1f", now.apart_ms);
  if (now.frame.rectification_ms > 0.0) diagnostics.addf("Rectification (ms)", "%.1f", now.frame.rectification_ms);
  for (const StageTime& time : now.frame.pipeline.times)
    diagnostics.addf("Stage " + time.stage + " (ms)", "%.1f", time.ms);
  diagnostics.add("Seeds of other sensors", now.frame.external_seeds);
  diagnostics.add("Seeds", now.frame.seeds);
  diagnostics.add("Seeds rejected", now.frame.rejected_seeds);
  diagnostics.add("Seeds of the first matching", now.frame.quasi_dense_seeds);
  diagnostics.addf("Pixels influenced by seeds (%)", "%.1f", 100.0 * now.frame.pipeline.propagated_share);
  const TemporalReport& temporal = now.frame.pipeline.temporal;
  diagnostics.addf("Pixels kept from earlier pairs (%)", "%.1f", 100.0 * temporal.kept_share);
  diagnostics.add("Result of the pair before repeated", temporal.repeated ? "yes" : "no");
  diagnostics.add("Pairs without memory of earlier ones", now.temporal_resets);
  diagnostics.add("Why, the last time", now.last_temporal_reset);
  const RowAlignment& rows = now.frame.pipeline.row_alignment;
  diagnostics.addf("Row offset (px)", "%.2f", rows.offset_rms_px);
  diagnostics.add("Row alignment", rows.note);
  diagnostics.addf("Row residuals before and after (px)", "%.2f, %.2f", rows.rms_before_px, rows.rms_after_px);
  diagnostics.addf("Valid pixels (%)", "%.1f", 100.0 * now.frame.valid_share);
  diagnostics.add("Parameter revision", now.revision);
  diagnostics.add("Notes", joined(now.frame.notes));
  diagnostics.add("Warnings", joined(now.frame.warnings));
  diagnostics.add("Last error", now.last_error);
}

bool LogThrottle::allow(const std::string& text, Clock::time_point now) {
  const auto old = [&](const Line& line) { return now - line.time >= period_; };
  recent_.erase(std::remove_if(recent_.begin(), recent_.end(), old), recent_.end());
  const auto same = std::find_if(recent_.begin(), recent_.end(), [&](const Line& line) { return line.text == text; });
  if (same != recent_.end()) {
    same->time = now;
    return false;
  }
  if (recent_.size() >= max_lines_) return false;
  recent_.push_back({text, now});
  return true;
}

}  // namespace fdp_stereo
