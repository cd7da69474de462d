#pragma once
// Events at a machine with controls, simulated by the reference integrator, and records of its components.
#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sim/plant/parameter_id.hpp"
#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::test {

inline sim::plant::Block default_block(const std::string& name) {
  const sim::Effect* effect = sim::library::compiled().find(name);
  return {effect, effect->default_parameters()};
}

/// Generator 2 of IEEE 14 with controls, and its response to a fault.
struct ComponentCase {
  sim::grid::Grid grid;
  std::size_t index = 0;
  sim::reference::ReferenceRun run;
  [[nodiscard]] const sim::plant::Plant& plant() const { return grid.plants[index]; }
};

/// A fault behind an impedance from `on` to `off`, simulated until `end` [s] at `rate` [1/s].
struct ComponentEvent {
  int bus = 4;
  double on = 1.0, off = 1.1, end = 5.0, rate = 240;
};

inline ComponentCase simulated_component(const std::vector<sim::plant::Block>& controls,
                                         const ComponentEvent& e = {}) {
  ComponentCase c{
      sim::grid::load_grid(source("configs/networks/ieee14_genrou.raw"),
                           source("configs/networks/ieee14_genrou.dyr"), sim::Conventions::psse()),
      0,
      {}};
  const auto plant = std::ranges::find(c.grid.plants, "2", &sim::plant::Plant::name);
  c.index = static_cast<std::size_t>(plant - c.grid.plants.begin());
  plant->controls.clear();
  for (const auto& block : controls) sim::plant::insert_block(*plant, block);
  sim::network::Event event;
  event.faults.push_back({c.grid.network.bus_index(e.bus), e.on, e.off, {0.02, 0.1}});
  sim::reference::ReferenceOptions options;
  options.t_end = e.end;
  options.rate = e.rate;
  options.rtol = 1e-10;
  options.atol = 1e-12;
  options.channels = {sim::Channel::V,     sim::Channel::theta, sim::Channel::P,   sim::Channel::Q,
                      sim::Channel::speed, sim::Channel::Efd,   sim::Channel::Ifd, sim::Channel::Tm};
  c.run = sim::reference::run_reference(c.grid, event, options);
  return c;
}
inline ComponentCase simulated_component(const std::vector<std::string>& names,
                                         const ComponentEvent& e = {}) {
  std::vector<sim::plant::Block> controls;
  for (const auto& name : names) controls.push_back(default_block(name));
  return simulated_component(controls, e);
}

/// Standard deviations of the Gaussian noise [pu].
struct ComponentNoise {
  double V = 0, P = 0, speed = 0, Efd = 0, Pm = 0;
};

/// Returns the component's record, with P, Q and Pm in pu on 100 MVA. Only the record of a machine has an
/// angle.
inline record::Record component_record(const ComponentCase& c, record::Component component,
                                       const ComponentNoise& noise = {}, unsigned seed = 7) {
  record::Record r;
  r.name = "simulated" + std::to_string(seed) + ".csv";
  r.base.mva = 100.0;
  r.component = component;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const double to_record = c.plant().mva / r.base.mva;
  for (int k = 0; k < c.run.samples; ++k) {
    const auto value = [&](int channel, double sigma) {
      return c.run.at(static_cast<int>(c.index), channel)[k] + sigma * normal(generator);
    };
    r.t.push_back(k / c.run.rate);
    r.V.push_back(value(0, noise.V));
    r.theta.push_back(component == record::Component::machine ? value(1, noise.V) : 0.0);
    r.P.push_back(value(2, noise.P) * to_record);
    r.Q.push_back(value(3, noise.P) * to_record);
    r.speed.push_back(value(4, noise.speed));
    r.Efd.push_back(value(5, noise.Efd));
    r.Ifd.push_back(value(6, noise.Efd));
    r.Pm.push_back(value(7, noise.Pm) * to_record);
  }
  if (component != record::Component::machine) r.angle = record::AngleSource::none;
  return r;
}

}  // namespace swingbank::validate::test
