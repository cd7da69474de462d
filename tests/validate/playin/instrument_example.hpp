#pragma once
// Faults at a generator with an exciter, recorded through instruments with errors.
#include <algorithm>
#include <random>

#include "sim/plant/measure.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::test {

inline sim::plant::Block instrument(const std::string& text) {
  Problems problems;
  const auto block = sim::plant::read_measurement(text, sim::library::compiled(), "test", problems);
  problems.raise();
  return *block;
}

/// Returns every `stride`-th sample of a record as seen through the instruments.
inline record::Record seen_through(const std::vector<sim::plant::Block>& chain, const record::Record& record,
                                   int stride) {
  sim::plant::TerminalRecord terminal{record.V, record.theta, record.P, record.Q, {}};
  auto phasors = sim::plant::phasors_of(terminal, 1 / record.step(), 60.0, "test");
  sim::plant::measure(chain, 1, phasors);
  terminal = sim::plant::terminal_of(phasors, record.theta.front());
  record::Record seen;
  seen.name = record.name;
  seen.base = record.base;
  for (std::size_t k = 0; k < record.t.size(); k += static_cast<std::size_t>(stride)) {
    seen.t.push_back(record.t[k]);
    seen.V.push_back(terminal.V[k]);
    seen.theta.push_back(terminal.theta[k]);
    seen.P.push_back(terminal.P[k]);
    seen.Q.push_back(terminal.Q[k]);
  }
  return seen;
}

/// Gaussian noise of 2e-3 pu on P and Q, 2e-4 on V [pu] and theta [rad].
inline void add_noise(record::Record& r, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    r.V[k] += 2e-4 * normal(generator);
    r.theta[k] += 2e-4 * normal(generator);
    r.P[k] += 2e-3 * normal(generator);
    r.Q[k] += 2e-3 * normal(generator);
  }
}

/// The plant with its instruments, and noisy records of two faults at 60 samples/s.
struct InstrumentExample {
  plant::PlantModel truth;
  std::vector<record::Record> records;
  explicit InstrumentExample(const std::vector<sim::plant::Block>& chain) {
    const auto with_exciter = [](sim::grid::Grid& grid) {
      std::ranges::find(grid.plants, "2", &sim::plant::Plant::name)
          ->controls.push_back({sim::library::compiled().find("SEXS"), {0.1, 10.0, 100.0, 0.05, -4.0, 5.0}});
    };
    for (const auto& [bus, seconds] : {std::pair{5, 0.1043}, {9, 0.1527}}) {
      const double at = 2.0 + 0.4 / 60;
      const auto run =
          simulate("ieee14_genrou", sim::Conventions::psse(), bus, at, at + seconds, 480.0, {}, with_exciter);
      const auto plant = std::ranges::find(run.grid.plants, "2", &sim::plant::Plant::name);
      truth.plant = *plant;
      record::Record plain = record_of(run, static_cast<int>(plant - run.grid.plants.begin()), 1);
      plain.name = "bus" + std::to_string(bus) + ".csv";
      records.push_back(seen_through(chain, plain, 8));
      add_noise(records.back(), static_cast<unsigned>(bus));
    }
    truth.name = "with instruments";
    truth.conventions = sim::Conventions::psse();
    truth.record_base.mva = truth.plant.mva;
    truth.plant.measurements = chain;
  }
};

}  // namespace swingbank::validate::test
