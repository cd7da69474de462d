#pragma once
// Simulated events and their records, shared by several tests of validation.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"
#include "sim/reference/reference.hpp"
#include "validate/playin/voltage_curve.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::test {

inline std::filesystem::path source(const std::string& path) {
  return std::filesystem::path(SWINGBANK_SOURCE) / path;
}

/// Returns the messages of the InputError thrown by `action`; empty if none is thrown.
template <class F>
std::vector<std::string> messages(F action) {
  std::vector<std::string> all;
  try {
    action();
  } catch (const InputError& error) {
    for (const auto& p : error.problems()) all.push_back(p.sentence());
  }
  return all;
}

/// Returns an effect with these values ("Kp=2,Ki=1"); all others are defaults.
inline sim::plant::Block block(const char* name, const char* values) {
  Problems problems;
  const sim::Effect* effect = sim::library::compiled().find(name);
  sim::plant::Block b{effect, effect->default_parameters()};
  sim::plant::set_parameters(b, values, name, problems);
  problems.raise();
  return b;
}

/// Replaces the fourth plant by a converter that regulates Q through two integrals and the voltage behind
/// them, with these values.
inline void put_converter(sim::grid::Grid& grid, const std::string& plant_control,
                          const std::string& electrical_control) {
  const std::string outer = "RefFlag=0,Kc=0,Qmax=2,Qmin=-2,Pmax=2,Ddn=20,Dup=20,fdbd1=0,fdbd2=0,";
  const std::string inner =
      "QFLAG=1,dbd1=-0.05,dbd2=0.05,Kqv=2,Kvp=1,Kvi=40,VMIN=0.8,VMAX=1.2,Imax=2,QMax=2,QMin=-2,PMAX=2,";
  sim::plant::Plant& plant = grid.plants[3];
  plant.machine = block("REGCA1", "");
  plant.controls = {block("REPCA1", (outer + plant_control).c_str()),
                    block("REECA1", (inner + electrical_control).c_str())};
}

struct Simulated {
  sim::grid::Grid grid;
  double t_on, t_off;
  sim::reference::ReferenceRun before, after;  ///< at switching times the values just before and just after
};

/// Simulates a fault at a bus of the grid in `s` with the reference integrator. Its rtol of 1e-10 per step
/// keeps its error near 1e-9, far below the tested errors.
inline Simulated with_fault(Simulated s, int bus, double rate, Complex z) {
  sim::network::Event event;
  event.faults.push_back({s.grid.network.bus_index(bus), s.t_on, s.t_off, z});
  sim::reference::ReferenceOptions options;
  options.rate = rate;
  options.t_end = 10.0;
  options.rtol = 1e-10;
  options.atol = 1e-12;
  options.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P, sim::Channel::Q,
                      sim::Channel::speed};
  s.before = sim::reference::run_reference(s.grid, event, options);
  options.after_switching = true;
  s.after = sim::reference::run_reference(s.grid, event, options);
  return s;
}

/// Simulates a fault in a grid of configs/networks; `change` modifies the grid before the simulation.
inline Simulated simulate(const std::string& name, sim::Conventions conventions, int bus, double t_on,
                          double t_off, double rate = 480.0, Complex z = {},
                          const std::function<void(sim::grid::Grid&)>& change = {}) {
  Simulated s{sim::grid::load_grid(source("configs/networks/" + name + ".raw"),
                                   source("configs/networks/" + name + ".dyr"), conventions),
              t_on,
              t_off,
              {},
              {}};
  if (change) change(s.grid);
  return with_fault(std::move(s), bus, rate, z);
}

/// Makes every machine a GENTPJ, whose current is a nonlinear function of its voltage, behind a transformer.
inline void put_behind_transformers(sim::grid::Grid& grid) {
  for (sim::plant::Plant& plant : grid.plants) {
    const sim::Effect* gentpj = sim::library::compiled().find("GENTPJ");
    plant.machine = {gentpj, gentpj->default_parameters()};
    plant.transformer = {sim::library::compiled().find("STEPUP"), {0.004, 0.12, 1.04}};
  }
}

/// Returns the record of one plant at every `stride`-th sample, P and Q on the machine's own base; Gaussian
/// noise of `noise` pu on P and Q and a tenth of it on V and theta.
inline record::Record record_of(const Simulated& s, int plant, int stride, double noise = 0.0) {
  record::Record r;
  r.name = "simulated.csv";
  r.base.mva = s.grid.plants[static_cast<std::size_t>(plant)].mva;
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const auto add = [&](std::vector<double>& channel, int c, int k, double sigma) {
    channel.push_back(s.before.at(plant, c)[k] + sigma * normal(generator));
  };
  for (int k = 0; k < s.before.samples; k += stride) {
    r.t.push_back(k / s.before.rate);
    add(r.V, 0, k, noise / 10);
    add(r.theta, 1, k, noise / 10);
    add(r.P, 2, k, noise);
    add(r.Q, 3, k, noise);
  }
  return r;
}

/// Returns the record with the angle integrated from a frequency [pu]. It lacks the steps at `switched` and
/// drifts by the frequency's noise.
inline record::Record by_frequency(record::Record r, const std::vector<double>& switched,
                                   double noise = 0.0) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0, noise);
  const double nominal = constants::turn * r.base.frequency;
  std::vector<double> derivative;  // [rad/s]
  for (std::size_t k = 0; k + 1 < r.t.size(); ++k) {
    const bool has_step =
        std::ranges::any_of(switched, [&](double s) { return r.t[k] <= s && s < r.t[k + 1]; });
    const std::size_t from = has_step ? k - 1 : k;
    derivative.push_back((r.theta[from + 1] - r.theta[from]) / (r.t[from + 1] - r.t[from]));
  }
  derivative.push_back(derivative.back());
  r.f.clear();
  for (std::size_t k = 0; k < r.t.size(); ++k) r.f.push_back(derivative[k] / nominal + normal(generator));
  for (std::size_t k = 1; k < r.t.size(); ++k)
    r.theta[k] = r.theta[k - 1] + nominal * r.f[k - 1] * (r.t[k] - r.t[k - 1]);
  r.angle = record::AngleSource::integrated;
  return r;
}

/// Returns the exact switching times, with both one-sided voltages if requested (they must be samples of the
/// run).
inline std::vector<switching::Switching> exact_switchings(const Simulated& s, int plant, bool one_sided) {
  std::vector<switching::Switching> list;
  for (const double t : {s.t_on, s.t_off}) {
    switching::Switching w{.time = t};
    if (one_sided) {
      const auto k = static_cast<int>(std::lround(t * s.before.rate));
      w.has_before = w.has_after = true;
      w.before = std::polar(s.before.at(plant, 0)[k], s.before.at(plant, 1)[k]);
      w.after = std::polar(s.after.at(plant, 0)[k], s.after.at(plant, 1)[k]);
    }
    list.push_back(w);
  }
  return list;
}

}  // namespace swingbank::validate::test
