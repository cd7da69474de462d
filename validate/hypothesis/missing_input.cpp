#include "validate/hypothesis/missing_input.hpp"

#include <algorithm>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Knots from the first switching (without one: the end of the steady window) on: close together while the
/// rotor swings, wider later.
std::vector<double> knots_of(const event::FitEvent& event) {
  const double begin = event.switchings.empty()
                           ? event.record.t[static_cast<std::size_t>(event.start.samples - 1)]
                           : event.switchings.front().time;
  const double end = event.record.t.back();
  constexpr double kFineKnots = 0.1, kGrowth = 1.06, kCoarseKnots = 0.4;  // [s]; a swing takes about a second
  std::vector<double> knots;
  double gap = kFineKnots;
  for (double t = begin; t < end - 0.5 * gap; t += gap) {
    knots.push_back(t);
    if (t > begin + 2.0) gap = std::min(kCoarseKnots, gap * kGrowth);
  }
  knots.push_back(end);
  return knots;
}

}  // namespace

double MissingInput::explains(const fit::Fit& without) const {
  std::size_t knots = 0;
  for (const auto& e : fit.events) knots += e.state.input(kind).t.size();
  return fit::gain(without, fit, fit::data_cost) - thresholds::adequacy.knot * static_cast<double>(knots);
}

double MissingInput::evidence(const fit::Fit& without) const {
  return fit::gain(without, fit, fit::criterion);
}

MissingInput infer_input(fit::InputKind kind, const sim::plant::PlantUnderTest& tested,
                         const event::WhitenedEvents& events, double spread, const fit::FitOptions& start) {
  MissingInput found{kind, {}};
  fit::FitOptions options = start;
  options.input = kind;
  options.bend = kind == fit::InputKind::torque ? 0.01 : 0.1;  // a second difference between knots [pu]
  options.iterations = 8;
  options.enough = 1e-3;
  options.lenient = true;
  if (options.start.empty())
    for (const event::FitEvent& e : events) {
      fit::EventState state;
      for (const auto& s : e.switchings) state.switchings.push_back(s.time);
      options.start.push_back(state);
    }
  for (std::size_t e = 0; e < events.size(); ++e) {
    auto& input = options.start[e].input(kind);
    const auto knots = knots_of(events[e]);
    if (input.t == knots) continue;  // it goes on from there
    input.t = knots;
    input.value.assign(knots.size(), 0.0);
  }
  found.fit = fit::fit(tested, events, fit::free_parameters(tested.plant, spread), options);
  return found;
}

}  // namespace swingbank::validate::hypothesis
