#include "validate/reduced/free_input.hpp"

#include <limits>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::reduced {

double FreeInput::reduced_chi2() const {
  return fit.values > 0 && fit.failed.empty() ? fit.reduced_chi2() : std::numeric_limits<double>::infinity();
}

FreeInput free_input(event::InputKind kind, const sim::plant::PlantUnderTest& tested,
                     const noise::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                     const fit::Fit& without, int threads) {
  FreeInput input;
  input.kind = kind;
  const std::vector<event::EventState> states = states_of(without.events);
  const bool near = without.reduced_chi2() < thresholds::noise.measurable;
  const bool torque = kind == event::InputKind::torque;
  try {
    SmoothInference found = infer_smooth(tested, events, free, {.torque = torque, .field = !torque}, threads,
                                         near ? &without : nullptr);
    const Inference& smooth = found.smooth;
    fit::Fit& f = input.fit;
    f.plant = smooth.plant;
    f.noise = smooth.noise;
    f.iterations = found.prior.steps + smooth.steps;
    for (std::size_t e = 0; e < events.size(); ++e) {
      fit::EventFit fitted;
      fitted.state = smooth.states[e];
      noise::compare(events, e, event::play({smooth.plant, tested.conventions}, events[e], fitted.state),
                     fitted);
      f.chi2 += fitted.chi2;
      f.values += fitted.values;
      f.events.push_back(std::move(fitted));
      input.deviation.push_back(torque ? smooth.events[e].torque_deviation
                                       : smooth.events[e].field_deviation);
    }
    const Inference none = linear_about(without.plant, tested, events, free, states, {}, threads);
    input.evidence = none.criterion - smooth.criterion;
    input.inference = std::make_shared<const Inference>(std::move(found.prior));
  } catch (const InputError& error) {
    input.fit = {};
    input.fit.failed = error.problems().front().sentence();
  }
  return input;
}

}  // namespace swingbank::validate::reduced
