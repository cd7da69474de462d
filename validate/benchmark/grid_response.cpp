#include "validate/benchmark/grid_response.hpp"

#include <fmt/format.h>

#include <cmath>

#include "sim/reference/reference.hpp"
#include "validate/plant/infinite_bus.hpp"

namespace swingbank::validate::benchmark {
namespace {

/// Impedances and sizes of a test on the base of the simulated plant.
class OnPlantBase {
 public:
  /// `mva`: base of the test over that of the simulated plant.
  OnPlantBase(const Test& test, double mva) : test_(test), mva_(mva) {}

  /// Returns the infinite bus's connection. The source has half the reactance, so that neither its reactance
  /// nor the lines' impedance is near zero. For a `scr_step` the line that opens is the first of two.
  [[nodiscard]] plant::InfiniteBusLink link() const {
    const Complex before = impedance(test_.grid->scr), source(0, before.imag() / 2);
    if (test_.kind != TestKind::scr_step) return {source.imag(), {before - source}};
    const Complex stays = impedance(test_.grid->scr + *test_.size) - source;
    return {source.imag(), {1.0 / (1.0 / (before - source) - 1.0 / stays), stays}};
  }
  [[nodiscard]] sim::network::Event event() const {
    sim::network::Event event;
    if (test_.kind == TestKind::scr_step) event.trips = {{0, test_.event, test_.end}};
    if (test_.kind == TestKind::voltage_dip)
      event.faults = {
          {0, test_.event, *test_.end, impedance(test_.grid->scr) * (1 + *test_.size) / -*test_.size}};
    if (is_reference_step(test_.kind)) {
      const auto step = [&](double time, double by) {
        const bool power = test_.kind == TestKind::p_reference_step;
        // A voltage reference is in pu of the voltage, the others are in pu of the MVA.
        const double size = test_.kind == TestKind::v_reference_step ? by : by * mva_;
        event.setpoint_steps.push_back({0, time, power ? 0 : size, power ? size : 0});
      };
      step(test_.event, *test_.size);
      if (test_.end) step(*test_.end, -*test_.size);
    }
    return event;
  }

 private:
  [[nodiscard]] Complex impedance(double scr) const {
    return std::polar(1 / (scr * mva_), std::atan(test_.grid->x_over_r));
  }
  const Test& test_;
  double mva_;
};

}  // namespace

record::Record grid_response(const Test& t, const InitialPoint& initial, const plant::PlantModel& tested,
                             const plant::PlantModel& simulated) {
  const double mva = tested.plant.mva / simulated.plant.mva;
  const OnPlantBase test(t, mva);
  const sim::grid::Grid grid =
      plant::infinite_bus_grid(simulated, initial.V, Complex(initial.P, initial.Q) * mva, test.link());
  sim::reference::ReferenceOptions options;
  options.t_end = t.post->second;
  options.rate = initial.rate;
  options.plants = {0};
  options.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P, sim::Channel::Q};
  const auto run = sim::reference::run_reference(grid, test.event(), options);
  if (run.outcome != sim::Outcome::stable)
    throw InputError({fmt::format("simulation ends at {:.4g} s: {}", run.stopped_at,
                                  run.outcome == sim::Outcome::lost_synchronism ? "synchronism is lost"
                                                                                : "the integrator fails"),
                      t.where,
                      fmt::format("the plant is behind a grid with a short-circuit ratio of {:g}",
                                  t.kind == TestKind::scr_step ? t.grid->scr + *t.size : t.grid->scr),
                      "correct the model, or test a stronger grid"});
  record::Record r;
  r.name = t.name;
  r.format = "generated";
  r.base = tested.record_base;
  const double to_record = simulated.plant.mva / r.base.mva;
  for (int k = 0; k < run.samples; ++k) {
    r.t.push_back(k / run.rate);
    r.V.push_back(run.at(0, 0)[k]);
    r.theta.push_back(run.at(0, 1)[k]);
    r.P.push_back(run.at(0, 2)[k] * to_record);
    r.Q.push_back(run.at(0, 3)[k] * to_record);
  }
  return r;
}

}  // namespace swingbank::validate::benchmark
