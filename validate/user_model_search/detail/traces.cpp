// Computation of the traces from the playback of the plant with the inferred input.
#include "validate/user_model_search/detail/traces.hpp"

#include <cmath>

#include "validate/switching/steady.hpp"

namespace swingbank::validate::user_model_search {
namespace {

/// Returns the time of the first sample after the start at which the voltage deviates by more than `level`
/// [s]; NaN: none.
double trigger_of(const event::FitEvent& e, double level) {
  const record::Record& r = e.played();
  const auto first = static_cast<std::size_t>(e.start.samples);
  const std::size_t k = switching::leaves(
      r.V, {.level = std::abs(e.start.voltage), .reach = level, .from = first, .in_a_row = 1});
  if (level > 0 && k < r.V.size()) return r.t[k];
  return std::numeric_limits<double>::quiet_NaN();
}

/// Plays the event into the plant with the inferred input. If the simulation fails, it is repeated with
/// relaxed tolerances (event::Playing::lenient).
playin::Response play_event(const sim::plant::PlantUnderTest& tested, const event::FitEvent& e,
                            const fit::EventState& state) {
  try {
    return event::play(tested, e, state);
  } catch (const InputError&) {
    return event::play(tested, e, state, {}, {.lenient = true});
  }
}

}  // namespace

std::vector<UserModelTrace> user_model_traces(const plant::PlantModel& model,
                                              const noise::WhitenedEvents& events,
                                              const reduced::FreeInput& input, double level) {
  std::vector<UserModelTrace> all;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const event::FitEvent& e = events[i];
    const fit::EventState& state = input.fit.events[i].state;
    const auto switchings = event::switchings_at(e, state);
    const playin::VoltageCurve curve = e.curve(switchings);
    // The signals are those of the instruments, as in the fit.
    const playin::Response r = play_event({input.fit.plant, model.conventions}, e, state);
    const double to_machine = e.record.base.mva / input.fit.plant.mva;
    UserModelTrace t;
    t.t = e.record.t;
    t.knots = state.input(input.kind).t;
    t.input = state.input(input.kind).value;
    t.begin = t.knots.front();
    t.trigger = trigger_of(e, level);
    const auto deviation = [&](const std::vector<double>& x, double scale) {
      std::vector<double> d;
      for (const double v : x) d.push_back(scale * (v - x.front()));
      return d;
    };
    std::vector<double> V;  // deviation of the played-in curve, which is smooth across filtered samples

    for (std::size_t k = 0, segment = 0; k < t.t.size(); ++k) {
      while (segment < switchings.size() && t.t[k] > switchings[segment].time) ++segment;
      V.push_back(std::abs(curve(static_cast<int>(segment), t.t[k])) - std::abs(e.start.voltage));
    }
    t.signal = {r.of(playin::Output::speed), V, deviation(r.of(playin::Output::P), to_machine),
                deviation(r.of(playin::Output::Q), to_machine), deviation(r.of(playin::Output::Ifd), 1.0)};
    t.rest = input.kind == fit::InputKind::torque ? event::start_at(e, state).P * to_machine
                                                  : r.of(playin::Output::Efd).front();
    all.push_back(std::move(t));
  }
  return all;
}

}  // namespace swingbank::validate::user_model_search
