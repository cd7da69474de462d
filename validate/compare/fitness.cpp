#include "validate/compare/fitness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/json.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::compare {
namespace {

using thresholds::Errors;
using thresholds::Phase;

/// Windows of an event without the intervals that the limits exclude.
class Phases {
 public:
  Phases(const EventComparison& e, const thresholds::Acceptance& by) : e_(e) {
    const double slack = e.record.time_slack();
    const bool switched = !e.switchings.empty();
    begins_ = slack + (switched ? e.switchings.front().time : e.windows.front().to);
    over_ = slack + (switched ? e.switchings.back().time : e.windows.front().to);
    if (switched) after_clearing_ = over_ + by.after_clearing;
    if (over_ > begins_) after_fault_ = begins_ + by.after_fault;
  }
  /// Returns the window of a sample; none if it is not judged.
  [[nodiscard]] std::optional<Phase> of(std::size_t sample) const {
    const double t = e_.record.t[sample];
    if (!e_.left_out.empty() && e_.left_out[sample]) return std::nullopt;
    if (t <= begins_) return Phase::pre_fault;
    if (t <= over_) return t <= after_fault_ ? std::nullopt : std::optional(Phase::fault);
    return t <= after_clearing_ ? std::nullopt : std::optional(Phase::post_fault);
  }

 private:
  const EventComparison& e_;
  double begins_ = 0, over_ = 0, after_fault_ = -1e300, after_clearing_ = -1e300;
};

/// Returns the deviation of a channel after the last switching; none if it is too small to be judged.
std::optional<Movement> movement_of(const EventComparison& e, const ChannelComparison& c,
                                    const Phases& phases, double percent, double limit) {
  if (c.measured.size() != c.residual.size()) return std::nullopt;
  double rest = 0, before = 0;
  for (std::size_t k = 0; k < c.measured.size(); ++k)
    if (phases.of(k) == Phase::pre_fault) rest += c.measured[k], ++before;
  if (before == 0) return std::nullopt;
  rest /= before;
  double measured = 0, error = 0, common = 0, samples = 0;
  for (std::size_t k = 0; k < c.measured.size(); ++k) {
    if (phases.of(k) != Phase::post_fault) continue;
    const double moved = c.measured[k] - rest;
    measured += moved * moved;
    error += c.residual[k] * c.residual[k];
    common += moved * (moved + c.residual[k]);
    ++samples;
  }
  if (samples == 0) return std::nullopt;
  const double rms = std::sqrt(measured / samples);
  if (rms < thresholds::movement.over_noise * c.noise || percent * rms < thresholds::movement.least)
    return std::nullopt;
  return Movement{e.record.name,           c.name, c.unit, rms * c.scale, 100 * std::sqrt(error / measured),
                  100 * common / measured, limit};
}

/// Text about the error nearest to its limit, or furthest above it.
std::string nearest_text(const Fitness& f) {
  const auto ratio = [](const JudgedErrors& row) {
    return thresholds::nearest(row.errors, row.limits).ratio;
  };
  const JudgedErrors& row = *std::ranges::max_element(f.rows, {}, ratio);
  const auto beyond = [](const Movement& m) { return m.error / m.limit; };
  if (const auto m = std::ranges::max_element(f.movements, {}, beyond);
      m != f.movements.end() && !(beyond(*m) <= ratio(row)))
    return fmt::format(
        "RMS error of {0} after the last switching of {1}: {2:.3g} % of the measured change of {0} ({3:.3g} {4}; limit "
        "{5:g} %). Regression coefficient of the modelled on the measured deviation: {6:.2f} (1: equal).",
        m->channel, m->event, m->error, m->measured, m->unit, m->limit, m->share / 100);
  const thresholds::Nearest at = thresholds::nearest(row.errors, row.limits);
  return fmt::format("{} of {} in the {} window of {}, {:.3g} % of {:g} MVA; the limit is {:g} %.", at.name,
                     row.channel, row.window(), row.event, at.error, f.mva, at.limit);
}

std::string verdict(const Fitness& f, int exceed) {
  const auto all = 3 * f.rows.size() + f.movements.size();
  return fmt::format("Fit for purpose: {} the limits {}). {}: {}",
                     f.fit ? fmt::format("yes (all {} errors of P and Q are within", all)
                           : fmt::format("no ({} of {} errors of P and Q exceed", exceed, all),
                     f.by.name, f.fit ? "Nearest to its limit" : "Largest violation", nearest_text(f));
}

std::string caption(const Fitness& f) {
  return fmt::format(
      "Errors (modelled − measured) in % of {:g} MVA, each with its limit, as defined in IEC "
      "61400-27-2: maximum error MXE, mean error ME, mean absolute error MAE. Limits {}: {}. "
      "Excluded: the first {:g} ms after the first switching and {:g} ms after the last. A "
      "star marks a value above its limit.",
      f.mva, f.by.name, f.by.source, 1e3 * f.by.after_fault, 1e3 * f.by.after_clearing);
}

/// Table cells; each of the three errors comes from its own row in `from`.
std::vector<report::Cell> cells_of(const JudgedErrors& of, const std::array<const JudgedErrors*, 3>& from) {
  std::vector<report::Cell> cells = {of.channel, std::string(of.window())};
  const auto add = [&](double error, double limit, const char* sign) {
    const bool within = std::abs(error) <= limit;
    cells.emplace_back(std::isfinite(error)
                           ? fmt::format("{:.2f} % (limit {}{:g} %){}", std::abs(error) < 0.005 ? 0.0 : error,
                                         sign, limit, within ? "" : " *")
                           : "not finite *",
                       within ? 0.0 : 1.0);
  };
  add(from[0]->errors.mxe, of.limits.mxe, "");
  add(from[1]->errors.me, of.limits.me, "±");
  add(from[2]->errors.mae, of.limits.mae, "");
  return cells;
}

nlohmann::json errors_json(const Errors& e) { return {{"mxe", e.mxe}, {"me", e.me}, {"mae", e.mae}}; }

}  // namespace

std::string_view JudgedErrors::window() const {
  if (switched) return thresholds::phase_name(phase);
  return phase == Phase::pre_fault ? "start of record" : "rest of record";
}

JudgedErrors errors_in(const EventComparison& e, const ChannelComparison& c, Phase phase,
                       const thresholds::Acceptance& by, double percent) {
  const Phases phases(e, by);
  JudgedErrors row{e.record.name, c.name, phase, 0, {}, {}, !e.switchings.empty()};
  for (std::size_t k = 0; k < c.residual.size(); ++k) {
    if (phases.of(k) != phase) continue;
    const double error = percent * c.residual[k], size = std::abs(error);
    ++row.samples;
    row.errors.me += error;
    row.errors.mae += size;
    if (!(size <= row.errors.mxe)) row.errors.mxe = size;  // NaN propagates
  }
  if (row.samples > 0) row.errors.me /= row.samples, row.errors.mae /= row.samples;
  if (!std::isfinite(row.errors.mae)) row.errors.mxe = row.errors.mae;
  return row;
}

Fitness not_judged(const thresholds::Acceptance& by, double mva, const std::string& why) {
  Fitness f;
  f.by = by;
  f.mva = mva;
  f.not_judged = why;
  f.sentence = fmt::format("Fit for purpose: not judged by the limits {} ({}).", by.name, why);
  return f;
}

Fitness judge_fitness(const std::vector<EventComparison>& events, double mva,
                      const thresholds::Acceptance& by) {
  Fitness f = not_judged(by, mva, "neither P nor Q is compared");
  int exceed = 0;
  for (const auto& e : events) {
    const Phases phases(e, by);
    for (const auto& c : e.channels) {
      if (!c.judged || (c.name != "P" && c.name != "Q")) continue;
      const double percent = 100 * e.record.base.mva / mva;
      if (auto m = movement_of(e, c, phases, percent, by.movement)) {
        exceed += m->exceeds();
        f.movements.push_back(std::move(*m));
      }
      for (const Phase phase : thresholds::kPhases) {
        JudgedErrors row = errors_in(e, c, phase, by, percent);
        if (row.samples == 0) continue;
        row.limits = by.of(c.name == "P" ? 0 : 1, phase);
        exceed += thresholds::exceeding(row.errors, row.limits);
        f.rows.push_back(std::move(row));
      }
    }
  }
  if (f.rows.empty()) return f;
  f.not_judged.clear();
  f.fit = exceed == 0;
  f.sentence = verdict(f, exceed);
  return f;
}

std::string complete_text(bool complete, const std::string& sentence) {
  return fmt::format("Statistically complete: {}. {}", complete ? "yes" : "no", sentence);
}

report::Table worst_fitness_table(const Fitness& f) {
  report::Table table{
      caption(f) + " Each value is the worst of all events.", {"channel", "window", "MXE", "ME", "MAE"}, {}};
  for (const char* channel : {"P", "Q"})
    for (const Phase phase : thresholds::kPhases) {
      std::array<const JudgedErrors*, 3> worst{};
      bool switched = false;
      const auto keep = [](const JudgedErrors*& kept, const JudgedErrors& row, double Errors::*which) {
        if (!kept || !(std::abs(row.errors.*which) <= std::abs(kept->errors.*which))) kept = &row;
      };
      for (const auto& row : f.rows) {
        if (row.channel != channel || row.phase != phase) continue;
        switched = switched || row.switched;
        keep(worst[0], row, &Errors::mxe);
        keep(worst[1], row, &Errors::me);
        keep(worst[2], row, &Errors::mae);
      }
      if (!worst[0]) continue;
      JudgedErrors named = *worst[0];
      named.switched = switched;
      table.rows.push_back(cells_of(named, worst));
    }
  return table;
}

report::Table movement_table(const Fitness& f) {
  report::Table table{
      "Change of P and Q after the last switching: RMS of the measured deviation from the mean before the event, "
      "RMS of modelled − measured in % of the measured RMS, and regression coefficient of the modelled on the "
      "measured deviation (1: equal). A star marks a value above its limit.",
      {"event", "channel", "measured change", "regression coefficient", "error"},
      {}};
  for (const Movement& m : f.movements)
    table.rows.push_back(
        {m.event, m.channel, fmt::format("{:.3g} {}", m.measured, m.unit),
         fmt::format("{:.2f}", m.share / 100),
         report::Cell(fmt::format("{:.3g} % (limit {:g} %){}", m.error, m.limit, m.exceeds() ? " *" : ""),
                      m.exceeds() ? 1.0 : 0.0)});
  return table;
}

nlohmann::json fitness_json(const Fitness& f) {
  nlohmann::json j = {
      {"fit_for_purpose", f.not_judged.empty() ? nlohmann::json(f.fit) : nullptr},
      {"sentence", f.sentence},
      {"limits", f.by.name},
      {"source", f.by.source},
      {"mva", f.mva},
      {"left_out_s", {{"after_fault", f.by.after_fault}, {"after_clearing", f.by.after_clearing}}},
      {"errors_percent_of_mva", nlohmann::json::array()},
      {"movement", nlohmann::json::array()}};
  for (const Movement& m : f.movements)
    j["movement"].push_back({{"record", m.event},
                             {"channel", m.channel},
                             {"unit", m.unit},
                             {"rms", m.measured},
                             {"error_percent", m.error},
                             {"regression_percent", m.share},
                             {"limit_percent", m.limit}});
  for (const auto& row : f.rows) {
    nlohmann::json one = errors_json(row.errors);
    one["record"] = row.event;
    one["channel"] = row.channel;
    one["window"] = thresholds::phase_name(row.phase);
    one["samples"] = row.samples;
    one["limits"] = errors_json(row.limits);
    j["errors_percent_of_mva"].push_back(std::move(one));
  }
  return j;
}

}  // namespace swingbank::validate::compare
