#include "validate/event/play.hpp"

#include <algorithm>

#include "base/problem.hpp"
#include "validate/playin/allowance.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/instruments.hpp"
#include "validate/playin/playback_batch.hpp"

namespace swingbank::validate::event {

InputError playback_failure(const std::string& record, const std::string& why) {
  return InputError({"playback of the record fails", record, why,
                     "check the model's parameters and the record's base and units"});
}

EventState prepared_state(const FitEvent& event) {
  EventState state;
  for (const switching::Switching& s : event.switchings) state.switchings.push_back(s.time);
  return state;
}

std::vector<switching::Switching> switchings_at(const FitEvent& event, const EventState& state) {
  auto switchings = event.switchings;
  for (std::size_t k = 0; k < state.switchings.size(); ++k) switchings[k].time = state.switchings[k];
  for (std::size_t k = 0; k < state.turns.size(); ++k) switchings[k].turn = state.turns[k];
  return switchings;
}

playin::OperatingPoint start_at(const FitEvent& event, const EventState& state) {
  playin::OperatingPoint start = event.start;
  if (playin::is_part(event.record)) {
    start.Efd += state.P;
    start.Pm += state.P;
    return start;
  }
  if (event.record.open_circuit()) return start;  // no current
  start.P += state.P;
  start.Q += state.Q;
  return start;
}

namespace {

/// Returns the specification of the run; `curve` and `given` must outlive it.
playin::PlaybackRun run_of(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                           const EventState& state, const Playing& how, const playin::VoltageCurve& curve,
                           const playin::Given* given) {
  playin::PlaybackRun run{.plant = &tested.plant,
                          .conventions = tested.conventions,
                          .record = &event.record,
                          .curve = &curve,
                          .start = start_at(event, state),
                          .given = given,
                          .angle = state.angle,
                          .speed = state.speed,
                          .tolerance = how.tolerance,
                          .until = how.until};
  if (how.hasty) {
    run.least_step = event.record.step() / 40;
    run.step_limit = 15 * event.record.samples();
  }
  if (how.lenient && how.allowance && !how.allowance->empty()) {
    run.allowance = *how.allowance;
  } else if (how.lenient) {
    run.allowance = playin::allowances(playin::linearise(run), event.channels, event.record.step());
    if (how.allowance) *how.allowance = run.allowance;
  }
  run.cache = how.cache;
  run.linear_sensitivities = event.channels;
  std::vector<playin::Output> more = {playin::Output::P, playin::Output::Q};  // instruments need both
  more.insert(more.end(), how.sensitive.begin(), how.sensitive.end());
  for (const playin::Output o : more)
    if (std::ranges::count(run.linear_sensitivities, o) == 0) run.linear_sensitivities.push_back(o);
  run.torque = state.torque;
  run.field = state.field;
  return run;
}

}  // namespace

playin::Response play(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                      const EventState& state, std::span<const playin::SensitivityParameter> along,
                      const Playing& how) {
  const playin::VoltageCurve curve = event.curve(switchings_at(event, state));
  const auto given = playin::given_of(event.record, curve.switchings(), event.start);
  return playin::observe(run_of(tested, event, state, how, curve, given ? &*given : nullptr), along);
}

Eigen::VectorXd rates_by_input(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                               const EventState& state, InputKind input) {
  const playin::VoltageCurve curve = event.curve(switchings_at(event, state));
  const auto given = playin::given_of(event.record, curve.switchings(), event.start);
  using Kind = playin::SensitivityParameter::Kind;
  return playin::rates_by_input(run_of(tested, event, state, {}, curve, given ? &*given : nullptr),
                                input == InputKind::torque ? Kind::torque : Kind::field);
}

playin::SeenAlong seen_along(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                             const EventState& state, std::span<const double> times) {
  const playin::VoltageCurve curve = event.curve(switchings_at(event, state));
  const auto given = playin::given_of(event.record, curve.switchings(), event.start);
  return playin::seen_along(run_of(tested, event, state, {}, curve, given ? &*given : nullptr), times);
}

std::vector<std::optional<playin::Response>> play_together(std::span<const sim::plant::Plant> plants,
                                                           const sim::Conventions& conventions,
                                                           const FitEvent& event, const EventState& state,
                                                           const Playing& how) {
  const playin::VoltageCurve curve = event.curve(switchings_at(event, state));
  const auto given = playin::given_of(event.record, curve.switchings(), event.start);
  std::vector<std::optional<playin::Response>> all(plants.size());
  std::vector<playin::PlaybackRun> runs;
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < plants.size(); ++k) try {
      const playin::PlaybackRun run =
          run_of({plants[k], conventions}, event, state, how, curve, given ? &*given : nullptr);
      if (!plants[k].measurements.empty()) {
        all[k] = playin::observe(run);
        continue;
      }
      runs.push_back(run);
      which.push_back(k);
    } catch (const InputError&) {  // no steady state at the start
    }
  auto responses = playin::simulate_playback_batch(runs);
  for (std::size_t k = 0; k < runs.size(); ++k) all[which[k]] = std::move(responses[k]);
  return all;
}

}  // namespace swingbank::validate::event
