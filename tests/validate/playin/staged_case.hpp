#pragma once
// Staged tests at generator 32 of IEEE 39, which one transformer connects to the grid, simulated by the
// reference integrator: steps of its references, a load rejection, and a step in an open circuit.
#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/validate/playin/component_case.hpp"

namespace swingbank::validate::test {

struct StagedCase {
  sim::grid::Grid grid;
  std::size_t index = 0;
  sim::reference::ReferenceRun run;
  [[nodiscard]] const sim::plant::Plant& plant() const { return grid.plants[index]; }
};

struct StagedRun {
  double open = std::numeric_limits<double>::infinity();  ///< time at which the breaker opens [s]
  double step = 1.0, dVref = 0, dPref = 0;                ///< [s], [pu]
  double end = 8, rate = 240;
  std::string machine = "GENROU";
};

inline StagedCase simulated_staged(const std::vector<std::string>& controls, const StagedRun& what) {
  StagedCase c{sim::grid::load_grid(source("configs/networks/ieee39_genrou.raw"),
                                    source("configs/networks/ieee39_genrou.dyr"), sim::Conventions::psse()),
               0,
               {}};
  const auto plant = std::ranges::find(c.grid.plants, "32", &sim::plant::Plant::name);
  c.index = static_cast<std::size_t>(plant - c.grid.plants.begin());
  plant->controls.clear();
  if (what.machine != "GENROU") plant->machine = default_block(what.machine);
  for (const auto& name : controls) sim::plant::insert_block(*plant, default_block(name));
  sim::network::Event event;
  if (what.open < what.end) {
    const auto& branches = c.grid.network.branches;
    const auto tie = std::ranges::find_if(
        branches, [&](const auto& b) { return b.from == plant->bus || b.to == plant->bus; });
    event.trips.push_back({static_cast<int>(tie - branches.begin()), what.open, {}});
  }
  if (what.dVref != 0 || what.dPref != 0)
    event.setpoint_steps.push_back({plant->generator, what.step, what.dVref, what.dPref});
  sim::reference::ReferenceOptions options;
  options.t_end = what.end;
  options.rate = what.rate;
  options.rtol = 1e-10;
  options.atol = 1e-12;
  options.lose_at = 1e9;
  options.channels = {sim::Channel::V,     sim::Channel::theta, sim::Channel::P,   sim::Channel::Q,
                      sim::Channel::speed, sim::Channel::Efd,   sim::Channel::Ifd, sim::Channel::Tm};
  c.run = sim::reference::run_reference(c.grid, event, options);
  return c;
}

/// A GENROU without saturation and a SEXS without lead-lag.
inline sim::plant::Plant unloaded_plant() {
  sim::plant::Plant plant;
  plant.name = "unloaded";
  plant.machine = default_block("GENROU");
  for (const char* name : {"S10", "S12"})
    plant.machine.p[static_cast<std::size_t>(plant.machine.effect->parameter_index(name))] = 0;
  plant.controls = {{sim::library::compiled().find("SEXS"), {1.0, 0.0, 60.0, 0.1, -20.0, 20.0}}};
  return plant;
}

/// Response of unloaded_plant() in an open circuit to a step `dVref` of its reference at 2 s, by an
/// independent implementation of the d axis and the classical Runge-Kutta method.
inline record::Record open_circuit_record(double dVref, double noise = 0, double field_noise = 0) {
  const sim::plant::Plant plant = unloaded_plant();
  const auto p = [&](const char* name) {
    return plant.machine.p[static_cast<std::size_t>(plant.machine.effect->parameter_index(name))];
  };
  const double K = plant.controls[0].p[2], TE = plant.controls[0].p[3], V0 = 1.01;
  const double wide = p("Xdp") - p("Xl"), narrow = p("Xdpp") - p("Xl");
  const double kd = (p("Xdp") - p("Xdpp")) / (wide * wide);
  struct State {
    double flux, damper, Efd;
  };
  const auto voltage = [&](const State& x) { return (x.flux * narrow + x.damper * (wide - narrow)) / wide; };
  const auto Ifd = [&](const State& x) { return x.flux - (p("Xd") - p("Xdp")) * kd * (x.damper - x.flux); };
  const auto derivative = [&](const State& x, double reference) {
    return State{(x.Efd - Ifd(x)) / p("Tdop"), (x.flux - x.damper) / p("Tdopp"),
                 (K * (reference - voltage(x)) - x.Efd) / TE};
  };
  const auto along = [](const State& x, double h, const State& d) {
    return State{x.flux + h * d.flux, x.damper + h * d.damper, x.Efd + h * d.Efd};
  };
  record::Record r;
  r.name = "open_circuit.csv";
  r.staged = {{record::StagedEvent::Kind::open_circuit},
              {.kind = record::StagedEvent::Kind::vref_step, .time = 2.0, .size = dVref}};
  r.angle = record::AngleSource::none;
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  constexpr double kRate = 60, kEnd = 10;
  constexpr int kParts = 100;
  State x{V0, V0, V0};
  for (int k = 0; k <= kRate * kEnd; ++k) {
    r.t.push_back(k / kRate);
    r.V.push_back(voltage(x) + noise * normal(generator));
    r.Efd.push_back(x.Efd + field_noise * normal(generator));
    r.Ifd.push_back(Ifd(x) + field_noise * normal(generator));
    const double h = 1 / kRate / kParts, reference = V0 + V0 / K + (k >= 2.0 * kRate ? dVref : 0.0);
    for (int i = 0; i < kParts; ++i) {
      const State a = derivative(x, reference), b = derivative(along(x, h / 2, a), reference),
                  c = derivative(along(x, h / 2, b), reference), d = derivative(along(x, h, c), reference);
      x = along(along(along(along(x, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
    }
  }
  for (auto* zero : {&r.theta, &r.P, &r.Q}) zero->assign(r.t.size(), 0.0);
  return r;
}

/// The record from `from` [s] on, with time starting at 0; noise of V, P, Q and of Efd, Ifd [pu].
inline record::Record staged_record(const StagedCase& c, std::vector<record::StagedEvent> staged,
                                    double from = 0, double noise = 0, double field_noise = 0,
                                    unsigned seed = 7) {
  record::Record r;
  r.name = "staged" + std::to_string(seed) + ".csv";
  r.base.mva = 100.0;
  r.staged = std::move(staged);
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const double to_record = c.plant().mva / r.base.mva;
  for (int k = static_cast<int>(from * c.run.rate); k < c.run.samples; ++k) {
    const auto value = [&](int channel, double sigma) {
      return c.run.at(static_cast<int>(c.index), channel)[k] + sigma * normal(generator);
    };
    r.t.push_back(k / c.run.rate - from);
    r.V.push_back(value(0, noise));
    r.theta.push_back(value(1, noise));
    r.P.push_back(value(2, noise) * to_record);
    r.Q.push_back(value(3, noise) * to_record);
    r.speed.push_back(value(4, noise / 100));
    r.Efd.push_back(value(5, field_noise));
    r.Ifd.push_back(value(6, field_noise));
    r.Pm.push_back(value(7, 0) * to_record);
  }
  return r;
}

}  // namespace swingbank::validate::test
