#include "validate/benchmark/benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "validate/benchmark/grid_response.hpp"
#include "validate/event/event.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::benchmark {
namespace {

using record::Record;
using thresholds::Phase;

/// Returns the staged event of a reference step, on the record's base.
record::StagedEvent staged_event(const Test& t, const plant::PlantModel& model, const Record& r) {
  record::StagedEvent e;
  const bool power = t.kind == TestKind::p_reference_step;
  e.kind = power ? record::StagedEvent::Kind::pref_step : record::StagedEvent::Kind::vref_step;
  e.time = t.event;
  if (t.end) e.until = *t.end;
  e.size = power ? *t.size * model.plant.mva / r.base.mva : *t.size;
  return e;
}

/// Returns the windows in order of time. An event without end has no window `during`.
std::vector<compare::Window> windows_of(const Test& t, const Record& r) {
  const Interval pre = t.pre.value_or(Interval{r.t.front(), t.event}),
                 post = t.post.value_or(Interval{t.last(), r.t.back()});
  std::vector<compare::Window> all = {{"pre", pre.first, pre.second}};
  if (t.end) {
    const Interval during = t.during.value_or(Interval{t.event, *t.end});
    all.push_back({"during", during.first, during.second});
  }
  all.push_back({"post", post.first, post.second});
  return all;
}

/// Adds a problem if the event or a window of the tests file reaches beyond the record.
void check_windows(const Test& t, const Record& r, Problems& problems) {
  const double slack = r.step(), from = r.t.front(), to = r.t.back();
  const auto check = [&](double a, double b, const std::string& what) {
    if (!(a >= from - slack && b <= to + slack))
      problems.add(fmt::format("{} of test '{}', {:g} to {:g} s", what, t.name, a, b), t.where,
                   fmt::format("{} contains {:g} to {:g} s", r.name, from, to),
                   "correct the times, or give a longer record");
  };
  check(t.event, t.last(), "event");
  if (t.pre) check(t.pre->first, t.pre->second, "window pre");
  if (t.during) check(t.during->first, t.during->second, "window during");
  if (t.post) check(t.post->first, t.post->second, "window post");
}

/// Returns the record from the first to the last window, with the switching times and the reference step of
/// the test.
Record record_of_test(const Test& t, const plant::PlantModel& model, Record r) {
  const auto windows = windows_of(t, r);
  r = record::stretch(std::move(r), windows.front().from, windows.back().to);
  r.name = t.name;
  r.switched = {t.event};
  if (t.end) r.switched.push_back(*t.end);
  if (is_reference_step(t.kind)) r.staged = {staged_event(t, model, r)};
  return r;
}

/// Returns 1 for each sample that is lost or outside all windows, otherwise 0.
std::vector<char> outside_windows(const Record& r, const std::vector<compare::Window>& windows) {
  std::vector<char> out(r.t.size(), 0);
  const double slack = r.time_slack();
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = (!r.lost.empty() && r.lost[k]) || std::ranges::none_of(windows, [&](const compare::Window& w) {
               return r.t[k] >= w.from - slack && r.t[k] <= w.to + slack;
             });
  return out;
}

compare::ChannelRule rule_of(playin::Output output, const record::RecordBase& base, double per_machine) {
  const compare::ChannelUnit unit = compare::channel_unit(output, base);
  const bool power = output == playin::Output::P || output == playin::Output::Q;
  return {.name = std::string(playin::output_name(output)),
          .unit = unit.name,
          .scale = unit.scale,
          .floor = 0,
          .starts_at_mean = false,
          .size = power ? per_machine : 1.0};
}

compare::ChannelComparison channel_of(const compare::ChannelRule& rule, const std::vector<double>& reference,
                                      const std::vector<double>& modelled,
                                      const compare::EventComparison& e) {
  compare::ChannelComparison c = compare::channel_curves(rule, reference, modelled);
  const auto before = compare::window_error(e.record.t, c.residual, e.left_out, e.windows.front(), true, 0);
  c.noise = std::sqrt(std::max(0.0, before.rms * before.rms - before.mean * before.mean));
  c.whole = compare::window_error(e.record.t, c.residual, e.left_out,
                                  {"", e.record.t.front(), e.record.t.back()}, true, c.noise);
  return c;
}

/// Returns the active or reactive current, P/V or Q/V [pu of the plant's MVA]. `power`: P or Q [pu of the
/// record's base]; `per_machine`: the plant's MVA over the record's base.
std::vector<double> current_of(const std::vector<double>& power, const std::vector<double>& V,
                               double per_machine) {
  std::vector<double> current(power.size());
  for (std::size_t k = 0; k < power.size(); ++k) current[k] = power[k] / per_machine / V[k];
  return current;
}

/// Adds the active and reactive current of a converter, because grid codes judge them during a fault. They
/// have no limits here. Adds nothing if the voltage of a compared sample is zero.
void add_currents(compare::EventComparison& e, double per_machine) {
  const std::vector<double>& modelled = e.playback.V.empty() ? e.record.V : e.playback.V;
  for (std::size_t k = 0; k < e.record.t.size(); ++k)
    if (!e.left_out[k] && !(e.record.V[k] > 0 && modelled[k] > 0)) return;
  const std::size_t powers = e.channels.size();
  for (std::size_t c = 0; c < powers; ++c) {
    const std::string name = e.channels[c].name;
    if (name != "P" && name != "Q") continue;
    e.channels.push_back(channel_of(
        {.name = name == "P" ? "Ip" : "Iq", .unit = "pu", .scale = 1, .floor = 0, .starts_at_mean = false},
        current_of(e.channels[c].measured, e.record.V, per_machine),
        current_of(e.channels[c].modelled, modelled, per_machine), e));
  }
}

/// Returns the response of a model; a failure names its plant file.
template <class Simulate>
auto response_of(const plant::PlantModel& model, const Simulate& simulate) {
  try {
    return simulate(model);
  } catch (const InputError& error) {
    Problem problem = error.problems().front();
    problem.what = std::filesystem::path(model.origin).filename().string() + ": " + problem.what;
    throw InputError(std::move(problem));
  }
}

/// Sets the record of a comparison, its windows and the samples outside them.
void take_record(const Test& t, Record r, compare::EventComparison& e) {
  e.record = std::move(r);
  e.windows = windows_of(t, e.record);
  e.left_out = outside_windows(e.record, e.windows);
}

/// Simulates both models behind the grid of the test. The response of the reference becomes the record.
void simulate_behind_grid(const Test& t, const BenchmarkInputs& in, compare::EventComparison& e) {
  const auto simulate = [&](const plant::PlantModel& model) {
    return record_of_test(t, in.model, grid_response(t, *in.initial, in.model, model));
  };
  take_record(t, response_of(*in.against, simulate), e);
  Record response = response_of(in.model, simulate);
  e.playback.P = std::move(response.P);
  e.playback.Q = std::move(response.Q);
  e.playback.V = std::move(response.V);
  e.switchings = event::prepare_events(in.model, {e.record}, {.step_shape = switching::StepShape::sharp})
                     .front()
                     .switchings;
}

/// Plays the record into the model, and into the reference model if there is one. Returns the response of the
/// latter.
playin::Playback play_record(const Test& t, const BenchmarkInputs& in, const Record& given,
                             compare::EventComparison& e) {
  take_record(t, record_of_test(t, in.model, given), e);
  const plant::PlantModel& reference = in.against ? *in.against : in.model;
  const event::FitEvent prepared =
      event::prepare_events(reference, {e.record}, {.step_shape = switching::StepShape::sharp}).front();
  e.switchings = prepared.switchings;
  const playin::VoltageCurve curve(prepared.record, prepared.switchings);
  const auto play = [&](const plant::PlantModel& model) {
    Record input = prepared.record;
    // The step of the Q reference is in pu of the MVA of the model under test, so it is converted for the
    // reference model.
    if (t.kind == TestKind::q_reference_step)
      for (record::StagedEvent& step : input.staged) step.size *= in.model.plant.mva / model.plant.mva;
    return playin::play_in(model.under_test(), input, curve);
  };
  playin::Playback other;
  if (in.against) other = response_of(*in.against, play);
  e.playback = response_of(in.model, play);
  return other;
}

TestResult run_test(const Test& t, const BenchmarkInputs& in, const Record& given) {
  TestResult result{.test = t, .event = {}, .rows = {}, .fitness = {}, .failure = {}};
  compare::EventComparison& e = result.event;
  const bool behind = t.behind_impedance();
  const double mva = in.model.plant.mva;
  playin::Playback other;
  try {
    if (behind)
      simulate_behind_grid(t, in, e);
    else
      other = play_record(t, in, given, e);
  } catch (const InputError& error) {
    result.failure = error.problems().front().sentence();
    result.fitness = compare::not_judged(in.by, mva, result.failure);
    return result;
  }
  const double per_machine = mva / e.record.base.mva;
  const auto outputs = in.against ? std::vector{playin::Output::P, playin::Output::Q}
                                  : playin::compared_outputs(e.record, true);
  for (const playin::Output o : outputs)
    e.channels.push_back(
        channel_of(rule_of(o, e.record.base, per_machine),
                   in.against && !behind ? output_of(other, o) : playin::output_of(e.record, o),
                   output_of(e.playback, o), e));
  if (behind)
    e.channels.push_back(
        channel_of(rule_of(playin::Output::V, e.record.base, per_machine), e.record.V, e.playback.V, e));
  if (in.model.plant.machine.effect->converter) add_currents(e, per_machine);
  for (const auto& c : e.channels)
    for (const Phase phase : thresholds::kPhases)
      if (compare::JudgedErrors row = compare::errors_in(e, c, phase, in.by, 100 / c.size); row.samples > 0) {
        if (has_limits(c.name)) row.limits = in.by.of(c.name == "P" ? 0 : 1, phase);
        result.rows.push_back(std::move(row));
      }
  result.fitness = compare::judge_fitness({e}, mva, in.by);
  return result;
}

}  // namespace

std::string_view window_name(Phase phase) {
  return phase == Phase::pre_fault ? "pre" : phase == Phase::fault ? "during" : "post";
}

std::vector<TestResult> run_benchmark(const std::vector<Test>& tests, const BenchmarkInputs& in) {
  Problems problems;
  for (std::size_t k = 0; k < tests.size(); ++k)
    if (!tests[k].behind_impedance()) check_windows(tests[k], in.records[k], problems);
  problems.raise();
  std::vector<TestResult> results(tests.size());
  in_parallel(
      tests.size(),
      [&](std::size_t k) {
        interruption_point();
        results[k] = run_test(tests[k], in, in.records[k]);
      },
      [&](int done, std::size_t k) {
        if (in.progress)
          in.progress(event::Phase::playing, tests[k].name, done, static_cast<int>(tests.size()));
      });
  return results;
}

bool passes(const std::vector<TestResult>& results) {
  return std::ranges::all_of(results, &TestResult::passes);
}

}  // namespace swingbank::validate::benchmark
