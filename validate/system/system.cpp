// Comparison of a simulated event with the records of all terminals, and ranking of the terminals.
#include "validate/system/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/constants.hpp"
#include "sim/plant/measure.hpp"
#include "validate/event/event.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/instruments.hpp"
#include "validate/report/figures.hpp"
#include "validate/switching/voltage_steps.hpp"
#include "validate/system/detail/run.hpp"

namespace swingbank::validate::system {
namespace {

constexpr int kMinQuiet = 5;  // least number of pre-event samples for the noise

double mean_of(const std::vector<double>& v, std::size_t n) {
  return std::accumulate(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(n), 0.0) / static_cast<double>(n);
}
/// Returns a - b [rad] less whole turns, so that the first value is within half a turn of zero.
std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  std::ranges::transform(a, b, d.begin(), std::minus<>());
  const double turns = constants::turn * std::round(d.front() / constants::turn);
  for (double& v : d) v -= turns;
  return d;
}

/// Returns the half width of filtered steps in records without a declared filter [s]; 0: no filtering.
double filter_reach_of(const SystemCase& system) {
  std::vector<record::Record> records;
  for (const SystemTerminal& t : system.terminals)
    if (!(sim::plant::memory(t.instruments) > 0)) records.push_back(t.record);
  if (switching::step_shape_of(records, switching::kStepThreshold) != switching::StepShape::filtered)
    return 0;
  double farthest = 0;
  for (const record::Record& r : records) {
    const auto found =
        switching::VoltageSteps(r).find(switching::kStepThreshold / 2, switching::StepShape::filtered);
    for (const switching::Switching& s : found.switchings) farthest = std::max(farthest, s.uncertainty);
  }
  return farthest;
}

/// Comparison of the terminals one by one.
class Comparer {
 public:
  Comparer(const SystemCase& system, const SystemRun& run, SystemComparison& out)
      : s_(system), run_(run), out_(out), undeclared_(filter_reach_of(system)) {}

  void terminal(std::size_t i) {
    const SystemTerminal& t = s_.terminals[i];
    const double filter_reach = filter_reach_at(t);
    compare::EventComparison e;
    e.record = t.record;
    e.record.name = t.name;
    e.notes = t.warnings;
    e.left_out = e.record.lost;
    for (const double at : out_.switching_times)
      e.switchings.push_back({.time = at, .uncertainty = out_.uncertainty});
    e.detected = s_.switching_times_from_records;
    if (const auto doubt = clock_doubt(t.record, out_.switching_times); !doubt.empty())
      e.notes.push_back(doubt);
    leave_out_filtered(e, filter_reach);
    const double begins = out_.switching_times.front() - filter_reach + t.record.time_slack();
    e.playback.start.samples =
        static_cast<int>(std::ranges::upper_bound(t.record.t, begins) - t.record.t.begin());
    if (e.playback.start.samples < kMinQuiet)
      throw InputError({fmt::format("{} samples before the event", e.playback.start.samples),
                        "terminal " + t.name, "noise and steady state are estimated from these samples",
                        "start the record at least 1 s before the event"});
    e.windows = compare::event_windows(e.record, e.switchings, 1.0, e.left_out);
    channels(i, e);
    out_.terminals.push_back(std::move(e));
  }

 private:
  /// Returns the distance from a switching within which samples are not compared [s]. It is the filter's
  /// window plus the range beside a step in which the cubic through the simulation's samples is wrong. Within
  /// this distance, an error of the switching time by a fraction of a millisecond would be visible.
  [[nodiscard]] double filter_reach_at(const SystemTerminal& t) const {
    const double memory = sim::plant::memory(t.instruments);
    return memory > 0 ? memory + 2 * t.record.step() / playin::kOversampling : undeclared_;
  }
  /// Marks samples within `reach` [s] of a switching as not compared.
  void leave_out(compare::EventComparison& e, double reach) const {
    e.left_out.resize(e.record.t.size(), 0);
    for (std::size_t k = 0; k < e.record.t.size(); ++k)
      if (std::ranges::any_of(out_.switching_times,
                              [&](double at) { return std::abs(e.record.t[k] - at) <= reach; }))
        e.left_out[k] = 1;
  }
  void leave_out_filtered(compare::EventComparison& e, double filter_reach) const {
    if (!(filter_reach > 0)) return;
    leave_out(e, filter_reach);
    e.notes.push_back(fmt::format(
        "The instruments' filters smooth the steps at switchings over up to {:.0f} ms on either side; these "
        "samples are not compared.",
        1e3 * filter_reach));
  }
  void channels(std::size_t i, compare::EventComparison& e) {
    const Modelled& m = run_.responses[i];
    const record::Record& r = s_.terminals[i].record;
    // The angle is undefined while a bolted fault reduces V to nearly zero.
    const bool gone = std::ranges::any_of(r.V, [](double v) { return v < 0.05; });
    out_.initial.push_back(add(e, {"V", "pu", 1, switching::kLeastNoise, shift()}, r.V, m.V));
    out_.initial.push_back(angle(i, e, gone));
    const record::RecordBase& base = s_.base;
    const auto output = [&](playin::Output o, const std::vector<double>& measured,
                            const std::vector<double>& modelled) {
      const compare::ChannelUnit u = compare::channel_unit(o, base);
      return add(e, {std::string(playin::output_name(o)), u.name, u.scale, u.floor, shift()}, measured,
                 modelled);
    };
    out_.initial.push_back(output(playin::Output::P, r.P, m.P));
    out_.initial.push_back(output(playin::Output::Q, r.Q, m.Q));
    output(playin::Output::speed, r.speed, m.speed);
    output(playin::Output::Efd, r.Efd, m.Efd);
    output(playin::Output::Ifd, r.Ifd, m.Ifd);
  }
  /// Compares the angle relative to the reference terminal. The frequency is compared instead at the
  /// reference terminal, at every terminal if no reference is named, and where the record contains a
  /// frequency but no angle. Returns the model's angle error before the event [rad]; NaN if the angle is not
  /// compared.
  double angle(std::size_t i, compare::EventComparison& e, bool gone) {
    const auto reference = static_cast<std::size_t>(std::max(s_.reference, 0));
    const record::Record &r = s_.terminals[i].record, &other = s_.terminals[reference].record;
    const std::string_view skip = gone ? "fault" : "";
    if (r.angle == record::AngleSource::none) return constants::nan;
    const bool by_meter = r.angle == record::AngleSource::integrated;
    if (s_.reference < 0 || i == reference || by_meter) {
      const double nominal = s_.base.frequency;
      const std::vector<char> compared = e.left_out;
      if (by_meter) leave_out(e, switching::kPeakReach * r.step());  // meters delay or smooth an angle step
      add(e, {"frequency", "mHz", 1e3 * nominal, noise::kLeastSpeedNoise, shift(), true, skip},
          by_meter ? r.f : compare::frequency_of(r.t, r.theta, nominal),
          compare::frequency_of(r.t, run_.responses[i].theta, nominal));
      e.left_out = compared;
      return constants::nan;
    }
    if (other.samples() != r.samples() || std::abs(other.t.front() - r.t.front()) > 1e-3 * r.step() ||
        std::abs(other.step() - r.step()) > 1e-6 * r.step())
      throw InputError({"angles with different sampling times",
                        "terminals " + e.record.name + " and " + s_.terminals[reference].name,
                        "angles can be subtracted only at equal sampling times",
                        "export both at the same rate, or leave compare.reference out"});
    const auto measured = difference(r.theta, other.theta);
    auto modelled = difference(run_.responses[i].theta, run_.responses[reference].theta);
    const double turns =
        constants::turn * std::round((modelled.front() - measured.front()) / constants::turn);
    for (double& v : modelled) v -= turns;
    return add(e, {"angle", "deg", 360 / constants::turn, switching::kLeastNoise, shift(), true, skip},
               measured, modelled);
  }
  [[nodiscard]] bool shift() const { return s_.steady_state == SteadyState::shift; }

  /// Adds a channel. Returns the model's mean error before the event; NaN if the channel was not measured.
  double add(compare::EventComparison& e, const compare::ChannelRule& rule,
             const std::vector<double>& measured, std::vector<double> modelled) {
    if (measured.empty()) return constants::nan;
    const auto quiet = static_cast<std::size_t>(e.playback.start.samples);
    const double off = mean_of(modelled, quiet) - mean_of(measured, quiet);
    if (shift())
      for (double& v : modelled) v -= off;
    e.channels.push_back(compare::compare_channel(rule, measured, modelled, e));
    return off;
  }

  const SystemCase& s_;
  const SystemRun& run_;
  SystemComparison& out_;
  double undeclared_;
};

/// Returns the bin with the largest normalised RMS / bound: the ratio and the bin's name.
std::pair<double, std::string> worst_bin(const compare::EventComparison& e) {
  double worst = 0;
  std::string where;
  const auto look = [&](const compare::ChannelComparison& c, const std::string& place,
                        const compare::TimeFrequencyBin& bin) {
    if (bin.empty() || !(bin.normalised / bin.bound > worst)) return;
    worst = bin.normalised / bin.bound;
    where = fmt::format("{} {}, {} noise ({:.3g} {})", c.name, place, report::times_noise(bin.normalised),
                        bin.rms * c.scale, c.unit);
  };
  for (const auto& c : e.channels) {
    if (!c.judged) continue;
    for (std::size_t w = 0; w < c.map.rows.size(); ++w) {
      look(c, e.windows[w].name, c.map.rows[w].all);
      for (std::size_t b = 0; b < c.map.rows[w].bands.size(); ++b)
        look(c, fmt::format("{} at {}", e.windows[w].name, compare::error_bands()[b].name),
             c.map.rows[w].bands[b]);
    }
    look(c, "whole record", c.map.whole);
  }
  return {worst, where};
}

/// Plays a plant's record into its own model.
void play_alone(const SystemCase& s, SystemComparison& c, TerminalRank& rank) {
  const SystemTerminal& t = s.terminals[rank.terminal];
  plant::PlantModel model;
  model.name = t.name;
  model.plant = s.grid.plants[static_cast<std::size_t>(t.plant)];
  // filters are omitted, because they act on the played-in voltage as on P and Q
  model.plant.measurements.clear();
  std::ranges::copy_if(t.instruments, std::back_inserter(model.plant.measurements),
                       [](const sim::plant::Block& b) { return playin::can_be_taken_back(*b.effect); });
  model.conventions = s.grid.conventions;
  model.record_base = s.base;
  record::Record record = t.record;
  if (clock_doubt(record, c.switching_times).empty())
    record.switched = c.switching_times;  // otherwise the steps of the record are used
  try {
    std::vector<compare::EventComparison> one = {compare::compare_event(model, std::move(record))};
    one.front().record.name = t.name;
    rank.alone = compare::judge(one);
    std::tie(rank.alone_worst, rank.alone_where) = worst_bin(one.front());
  } catch (const InputError& error) {
    rank.alone_where = "playback failed: " + error.problems().front().sentence();
    c.terminals[rank.terminal].notes.push_back("Playback of the plant alone: " + rank.alone_where);
  }
}

bool fails_alone(const TerminalRank& r) { return r.alone && !r.alone->adequate; }

void rank_terminals(const SystemCase& s, SystemComparison& c) {
  for (std::size_t i = 0; i < c.terminals.size(); ++i) {
    TerminalRank r;
    r.terminal = i;
    std::tie(r.worst, r.where) = worst_bin(c.terminals[i]);
    if (s.terminals[i].plant >= 0) play_alone(s, c, r);
    c.ranking.push_back(std::move(r));
  }
  std::ranges::stable_sort(c.ranking, [](const TerminalRank& a, const TerminalRank& b) {
    if (fails_alone(a) != fails_alone(b)) return fails_alone(a);
    return fails_alone(a) ? a.alone_worst > b.alone_worst : a.worst > b.worst;
  });
  const TerminalRank& first = c.ranking.front();
  const auto failing = std::ranges::count_if(c.ranking, fails_alone);
  const auto played =
      std::ranges::count_if(c.ranking, [](const TerminalRank& r) { return r.alone.has_value(); });
  if (c.adequacy.adequate)
    c.culprit = "All terminals are within the limits.";
  else if (failing > 0)
    c.culprit = fmt::format(
        "The model of the plant at terminal {} fails in playback of its recorded voltage ({}); "
        "correct this model first.{}",
        s.terminals[first.terminal].name, first.alone_where,
        failing > 1 ? fmt::format(" {} more plants fail in playback.", failing - 1) : "");
  else
    c.culprit = fmt::format(
        "Largest error at terminal {} ({}).{}", s.terminals[first.terminal].name, first.where,
        played > 0 ? " Every plant that could be played back is adequate with its recorded voltage, so the "
                     "error is in the network, the loads, the event, or another plant."
                   : "");
}

}  // namespace

SystemComparison compare_system(const SystemCase& s) {
  SystemComparison c;
  c.switching_times = switching_times_of(s.event);
  sim::network::Event event = s.event;
  if (s.switching_times_from_records) {
    const auto written = c.switching_times;
    c.switching_times = estimate_switching_times(s, c.uncertainty);
    event = moved(event, written, c.switching_times);
  }
  for (const auto& t : s.terminals)
    if (c.switching_times.front() < t.record.t.front())
      throw InputError({fmt::format("an event at {:g} s", c.switching_times.front()), "terminal " + t.name,
                        fmt::format("its record begins at {:g} s", t.record.t.front()),
                        "give the event's switching times on the records' clock"});
  const SystemRun run = run_system(s, event);
  c.outcome = run.outcome;
  c.stopped_at = run.stopped_at;
  Comparer comparer(s, run, c);
  for (std::size_t i = 0; i < s.terminals.size(); ++i) comparer.terminal(i);
  c.adequacy = compare::judge(c.terminals);
  rank_terminals(s, c);
  if (c.outcome != sim::Outcome::stable)
    c.notes.push_back(
        fmt::format("The simulation ended at {:.3f} s: {}. Later samples repeat its last value.",
                    c.stopped_at, sim::outcome_name(c.outcome)));
  if (s.switching_times_from_records)
    c.notes.push_back(fmt::format(
        "Switching times were estimated from the records (each to ± {:.1f} ms) and refined by "
        "the fit of the model to the records. Give them (event.switching_times = \"given\") where they "
        "are known.",
        1e3 * c.uncertainty));
  if (s.steady_state == SteadyState::shift)
    c.notes.push_back(
        "The difference before the event was subtracted from every channel (compare.steady_state "
        "= \"shift\"), so only the response to the event is judged. The table of the steady "
        "state shows the difference.");
  return c;
}

}  // namespace swingbank::validate::system
