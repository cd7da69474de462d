#include "validate/event/play.hpp"

#include <algorithm>

#include "validate/playin/allowance.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/instruments.hpp"

namespace swingbank::validate::event {

std::vector<playin::Switching> switchings_at(const FitEvent& event, const EventState& state) {
  auto switchings = event.switchings;
  for (std::size_t k = 0; k < state.switchings.size(); ++k) switchings[k].time = state.switchings[k];
  return switchings;
}

playin::OperatingPoint start_at(const FitEvent& event, const EventState& state) {
  playin::OperatingPoint start = event.start;
  if (playin::is_part(event.record)) {
    start.Efd += state.P;
    start.Pm += state.P;
    return start;
  }
  if (event.record.open_circuit()) return start;  // nothing flows
  start.P += state.P;
  start.Q += state.Q;
  return start;
}

playin::Response play(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                      const EventState& state, std::span<const playin::Direction> along, const Playing& how) {
  const playin::VoltageCurve curve(event.played(), switchings_at(event, state));
  const playin::OperatingPoint start = start_at(event, state);
  const auto given = playin::given_of(event.record, curve.switchings(), event.start);
  playin::Drive run{.plant = &tested.plant,
                    .conventions = tested.conventions,
                    .record = &event.record,
                    .curve = &curve,
                    .start = start,
                    .given = given ? &*given : nullptr,
                    .angle = state.angle,
                    .speed = state.speed,
                    .tolerance = how.tolerance,
                    .until = how.until};
  if (how.hasty) {
    run.least_step = event.record.step() / 40;
    run.step_limit = 15 * event.record.samples();
  }
  if (how.lenient)
    run.allowance = playin::allowances(playin::linearise(run), event.channels, event.record.step());
  if (how.linear_slopes) {
    run.linear_slopes = event.channels;
    for (const playin::Output o : {playin::Output::P, playin::Output::Q})  // instruments need both
      if (std::ranges::count(event.channels, o) == 0) run.linear_slopes.push_back(o);
  }
  if (how.input == InputKind::torque) run.torque = state.input;
  if (how.input == InputKind::field) run.field = state.input;
  return playin::observe(run, along);
}

}  // namespace swingbank::validate::event
