#include "validate/usability/usability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/in_parallel.hpp"
#include "base/json.hpp"
#include "sim/reference/reference.hpp"
#include "validate/plant/infinite_bus.hpp"

namespace swingbank::validate::usability {
namespace {

using sim::plant::Plant;
namespace network = sim::network;

/// Returns the control with the voltage reference; null: none.
const sim::Effect* regulator_of(const Plant& plant) {
  for (const sim::Slot slot : {sim::Slot::exciter, sim::Slot::plant_control})
    for (const auto& control : plant.controls)
      if (control.effect->slot == slot) return control.effect;
  return nullptr;
}

/// Returns the plant at an infinite bus. Half the reactance is that of a line and half that of the source, so
/// that neither is near zero.
sim::grid::Grid grid_of(const plant::PlantModel& model, const OperatingState& at) {
  return plant::infinite_bus_grid(
      model, at.voltage, Complex(at.P, at.Q) / model.plant.mva,
      {.source = kStudyReactance / 2, .lines = {Complex(0, kStudyReactance / 2)}});
}

/// Returns the step at t = 0. A reactor at the plant's bus multiplies voltage and reactance of the Thévenin
/// source by the same factor, here 1 - kStudyStep.
network::Event step_of(const Plant& plant, Complex voltage) {
  if (regulator_of(plant)) return {.faults = {}, .trips = {}, .setpoint_steps = {{0, 0.0, kStudyStep, 0.0}}};
  const double susceptance = (1 / (1 - kStudyStep) - 1) / kStudyReactance;
  return {
      .faults = {}, .trips = {}, .load_steps = {{0, Complex(0, susceptance * std::norm(voltage)), 0.0, {}}}};
}

/// P and Q of a run, as deviations from the operating point [pu].
struct Deviation {
  std::vector<std::vector<double>> of;  ///< [P, Q][sample], without the operating point itself
  bool stable = false;                  ///< the run reached its end in synchronism
  double until = 0;                     ///< end of the run [s]
  [[nodiscard]] double largest(std::size_t signal) const {
    double most = 0;
    for (const double v : of[signal]) most = std::max(most, std::abs(v));
    return most;
  }
  /// Whether the response changes less from sample to sample in the second half of the run than in the first.
  [[nodiscard]] bool decays() const {
    double half[2] = {0, 0};
    for (const auto& y : of)
      for (std::size_t k = 1; k < y.size(); ++k) half[2 * k > y.size()] += std::pow(y[k] - y[k - 1], 2);
    return half[1] <= half[0];
  }
};

constexpr double kStudyRate = 30;         ///< samples per second: oscillations up to 15 Hz
constexpr double kStudyTolerance = 1e-9;  ///< error per step of the integrator

Deviation simulate(const sim::grid::Grid& grid, const network::Event& event) {
  sim::reference::ReferenceOptions options;
  options.t_end = kStudyDuration;
  options.rate = kStudyRate;
  options.rtol = kStudyTolerance;
  options.atol = kStudyTolerance / 100;
  options.plants = {0};
  options.channels = {sim::Channel::P, sim::Channel::Q};
  const auto run = sim::reference::run_reference(grid, event, options);
  Deviation d;
  d.stable = run.outcome == sim::Outcome::stable;
  d.until = run.stopped_at;
  for (int c = 0; c < 2; ++c) {
    const double* y = run.at(0, c);
    auto& deviation = d.of.emplace_back();
    for (int k = 1; k < run.samples; ++k) deviation.push_back(y[k] - y[0]);
  }
  return d;
}

UsabilityAt check_at(const plant::PlantModel& model, const OperatingState& state) {
  UsabilityAt at;
  at.state = state;
  const sim::grid::Grid grid = grid_of(model, state);
  try {
    sim::plant::operating_point(grid.plants.front(), state.voltage, grid.network.base_mva, grid.conventions);
    at.initialises = true;
    const Deviation still = simulate(grid, {});
    if (!still.stable) {
      at.failure = fmt::format("without a disturbance the simulation ends after {:.3g} s of {:g} s",
                               still.until, kStudyDuration);
      return at;
    }
    at.drift_P = 100 * still.largest(0);
    at.drift_Q = 100 * still.largest(1);
    const Deviation moved = simulate(grid, step_of(model.plant, state.voltage));
    at.oscillation = least_damped_oscillation(moved.of, kStudyRate, kSampleError);
    at.damped = moved.stable && moved.decays();
    if (auto& o = at.oscillation) {
      // The decay in one radian must exceed the error of a sample. Otherwise rounding errors determine the
      // sign of the damping ratio.
      at.damped = at.damped && o->damping * o->amplitude > kSampleError;
      o->amplitude *= 100;
    }
  } catch (const InputError& error) {
    at.failure = error.problems().front().sentence();
  }
  return at;
}

}  // namespace

std::string Usability::verdict() const {
  if (!not_checked.empty()) return "Usability was not checked";
  const auto all = [&](auto holds) { return std::ranges::all_of(at, holds); };
  if (!all([](const UsabilityAt& a) { return a.initialises; }))
    return "Does not initialise at every operating point";
  if (!all([](const UsabilityAt& a) { return a.failure.empty(); }))
    return "Cannot be simulated at every operating point";
  if (!all([](const UsabilityAt& a) { return a.damped; }))
    return "Initialises, but the step response is undamped";
  return "Initialises; the step response is damped";
}

bool Usability::usable() const {
  return not_checked.empty() && std::ranges::all_of(at, [](const UsabilityAt& a) {
           return a.initialises && a.failure.empty() && a.damped;
         });
}

Usability check_usability(const plant::PlantModel& model, const std::vector<OperatingState>& states) {
  Usability all;
  if (model.reading.component != record::Component::plant)
    all.not_checked =
        fmt::format("the records are those of the {} alone, without the plant's operating point",
                    record::component_name(model.reading.component));
  else if (states.empty())
    all.not_checked = "no record could be played in, so no operating point is known";
  else if (const auto at =
               std::ranges::find_if(states, [](const auto& s) { return !(std::abs(s.voltage) > 0); });
           at != states.end())
    all.not_checked = at->event + " has no voltage before the event";
  if (!all.not_checked.empty()) return all;
  const sim::Effect* regulator = regulator_of(model.plant);
  all.step =
      regulator
          ? fmt::format("step of the reference of {} by {:+g} pu", regulator->name, kStudyStep)
          : fmt::format(
                "switching of a shunt reactor at the plant's bus that reduces the Thévenin voltage and reactance of the grid by {:g} %",
                100 * kStudyStep);
  all.at.resize(states.size());
  in_parallel(
      states.size(), [&](std::size_t k) { all.at[k] = check_at(model, states[k]); }, [](int) {});
  return all;
}

nlohmann::json usability_json(const Usability& usability) {
  nlohmann::json j = {
      {"verdict", usability.verdict()},
      {"usable", usability.not_checked.empty() ? nlohmann::json(usability.usable()) : nullptr},
      {"not_checked", usability.not_checked},
      {"step", usability.step},
      {"reactance_pu", kStudyReactance},
      {"duration_s", kStudyDuration},
      {"operating_points", nlohmann::json::array()}};
  for (const UsabilityAt& at : usability.at) {
    nlohmann::json one = {{"record", at.state.event},      {"P_MW", at.state.P},
                          {"Q_Mvar", at.state.Q},          {"V_pu", std::abs(at.state.voltage)},
                          {"initialises", at.initialises}, {"failure", at.failure}};
    const bool simulated = at.failure.empty();
    one["drift_P_percent_of_mva"] = simulated ? nlohmann::json(at.drift_P) : nullptr;
    one["drift_Q_percent_of_mva"] = simulated ? nlohmann::json(at.drift_Q) : nullptr;
    one["damped"] = simulated ? nlohmann::json(at.damped) : nullptr;
    one["oscillation"] = nullptr;
    if (const auto& o = at.oscillation)
      one["oscillation"] = {{"frequency_hz", o->frequency},
                            {"damping_ratio", o->damping},
                            {"amplitude_percent_of_mva", o->amplitude}};
    j["operating_points"].push_back(std::move(one));
  }
  return j;
}

}  // namespace swingbank::validate::usability
